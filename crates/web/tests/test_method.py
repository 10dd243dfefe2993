"""The method step by step: every stage of a round is shown, and its numbers fit together."""

import pytest

ADAPTIVE = [
    "Film", "Guides", "Filtered", "Error", "Weights", "Runs", "Slots", "Contributions", "Film after",
]
UNIFORM = ["Film", "Slots", "Contributions", "Film after"]
# Of each picture that is shown: its size, and how many colours it has.
PICTURES = """() => [...document.querySelectorAll('#stage-pictures figure > canvas')].map((canvas) => {
  const { width, height } = canvas;
  const { data } = canvas.getContext('2d').getImageData(0, 0, width, height);
  const colors = new Set(new Uint32Array(data.buffer)).size;
  return { width, height, colors, title: canvas.getAttribute('aria-label') };
})"""


class Reader:
    """Somebody who reads the method on a page."""

    def __init__(self, page, width=64):
        self.page, self.tab = page, page.tab
        self.tab.locator("#to-method").click()
        self.wait_for(1)
        self.choose("width", str(width))

    def choose(self, control, choice):
        """Chooses something, which begins a render anew."""
        self.tab.evaluate("delete document.getElementById('method').dataset.round")
        self.tab.locator(f"#method-{control}").select_option(choice)
        self.wait_for(1)

    def wait_for(self, round):
        what = "round => document.getElementById('method').dataset.round === String(round)"
        self.page.wait(what, round)

    def press(self, key):
        self.tab.locator("#method").press(key)

    def stage(self):
        return self.tab.evaluate("document.getElementById('method').dataset.stage")

    def facts(self):
        return self.tab.evaluate(
            """() => Object.fromEntries([...document.querySelectorAll('[data-fact]')]
              .map((entry) => [entry.dataset.fact, entry.textContent]))"""
        )

    def read_round(self, on):
        """The stages of the round, from the first to the last: names, texts, facts, pictures; `on`
        goes from one to the next."""
        stages = []
        count = self.tab.locator("#stages button").count()
        for at in range(count):
            if at > 0:
                on()
            pressed = self.tab.locator("#stages [aria-pressed=true]").all_inner_texts()
            assert pressed == [self.stage()]
            stages.append({
                "name": self.stage(),
                "text": self.tab.locator("#stage-text").inner_text(),
                "facts": self.facts(),
                "pictures": self.tab.evaluate(PICTURES),
            })
            self.page.screenshot(f"method-{self.stage().lower().replace(' ', '-')}")
        return stages


def names(stages):
    return [stage["name"] for stage in stages]


def numbers(stages):
    facts = {}
    for stage in stages:
        facts |= stage["facts"]
    return facts


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
