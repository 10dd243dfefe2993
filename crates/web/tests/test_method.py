"""The method step by step: every stage of a round is shown, and its numbers fit together."""

import pytest

from reader import Reader, names, numbers

ADAPTIVE = [
    "Film", "Guides", "Filtered", "Error", "Weights", "Runs", "Slots", "Contributions",
    "Film after",
]
UNIFORM = ["Film", "Slots", "Contributions", "Film after"]


def test_a_round_is_stepped_through_by_buttons(visit):
    reader = Reader(visit())
    def on():
        reader.tab.locator("#next").click()
    first = reader.read_round(on)
    assert names(first) == UNIFORM
    assert int(numbers(first)["samples-after"]) == 5 * 64 * 48
    on()
    reader.wait_for(2)
    second = reader.read_round(on)
    assert names(second) == ADAPTIVE
    for stage in second:
        assert len(stage["text"]) > 60, stage["name"]
        assert stage["pictures"], stage["name"]
        for picture in stage["pictures"]:
            assert picture["width"] == 64 and picture["title"]
            assert picture["colors"] > 1, f"{stage['name']}: {picture['title']} shows something"
    assert len({stage["text"] for stage in second}) == len(second)


def test_the_numbers_of_rounds_fit_together(visit):
    reader = Reader(visit())
    pixels, before = 64 * 48, 0
    for round in range(1, 4):
        reader.wait_for(round)
        facts = numbers(reader.read_round(lambda: reader.press("ArrowRight")))
        slots = int(facts["slots"])
        assert int(facts["samples-before"]) == before
        assert int(facts["samples-after"]) == before + slots
        assert facts["adds-up"].startswith("yes")
        assert slots == int(facts["budget"]) == (5 * pixels if round == 1 else pixels)
        if round > 1:
            assert 0 < int(facts["runs"]) <= slots
            assert int(facts["longest-run"]) > 1, "some pixel got more than the average"
        before += slots
        reader.press("n")


def test_keys_go_back_and_forth(visit):
    reader = Reader(visit())
    press = reader.press
    press("ArrowRight")
    assert reader.stage() == "Slots"
    press("ArrowLeft")
    assert reader.stage() == "Film"
    press("ArrowLeft")
    assert reader.stage() == "Film", "there is nothing before"
    press("n")
    reader.wait_for(2)
    reader.tab.locator("#stages [data-stage=Error]").click()
    press("ArrowRight")
    assert reader.stage() == "Weights"


@pytest.mark.parametrize("allocator, stage", [("paper", "Streams"), ("atomic", "Runs")])
def test_other_choices_show_other_rounds(visit, allocator, stage):
    reader = Reader(visit())
    reader.choose("allocator", allocator)
    reader.choose("estimator", "halves")
    reader.choose("scene", "opening")
    reader.choose("budget", "2")
    reader.tab.locator("#next-round").click()
    reader.wait_for(2)
    stages = reader.read_round(lambda: reader.tab.locator("#next").click())
    facts = numbers(stages)
    assert stage in names(stages)
    assert 0 < int(facts["slots"]) <= int(facts["budget"])
    assert facts["adds-up"].startswith("yes")


def test_who_is_quick_sees_the_method_all_the_same(visit):
    page = visit()
    page.tab.evaluate("document.getElementById('to-method').click()")
    page.wait("document.getElementById('method').dataset.round === '1'")


def test_the_picture_waits_while_the_method_is_read(visit):
    page = visit()
    page.wait_for_samples(1)
    reader = Reader(page)
    assert page.tab.locator("#render").is_hidden()
    before = page.samples()
    page.tab.wait_for_timeout(500)
    assert page.samples() == before
    page.tab.locator("#to-render").click()
    page.wait_for_samples(before + 1)
    page.tab.locator("#to-method").click()
    assert reader.stage() == "Film", "the reader comes back to where they were"


def test_the_method_fits_a_narrow_screen(visit):
    page = visit(viewport={"width": 360, "height": 740}, has_touch=True)
    reader = Reader(page)
    reader.tab.locator("#next-round").click()
    reader.wait_for(2)
    for button in page.tab.locator("#stages button").all():
        button.click()
        assert not page.is_wider_than_the_screen(), button.inner_text()
    page.screenshot("method-narrow")
