"""The page renders, does what hands and keys tell it, and fits a phone."""

import pathlib
import time

PAGE = pathlib.Path(__file__).parents[1] / "page"
CAMERA_KEYS = ["ArrowLeft", "ArrowUp", "Shift+ArrowRight", "+", "-"]


def test_the_first_picture_is_there_within_three_seconds(visit):
    start = time.monotonic()
    page = visit()
    page.wait_for_samples(1)
    took = time.monotonic() - start
    print(f"first picture after {took:.2f} s")
    assert took < 3
    assert page.colors() > 1000, "it is a picture"
    page.wait_for_samples(4)
    page.screenshot("page")


def test_nothing_leaves_the_machine(visit, address):
    page = visit()
    page.wait_for_samples(1)
    assert page.requests, "it has loaded its own files"
    assert [url for url in page.requests if not url.startswith((address, "data:"))] == []


def test_every_layer_is_shown_with_its_legend(visit):
    page = visit()
    page.tab.locator("#width").select_option("160")
    page.wait("picture.width === 160")
    page.wait_for_samples(4)
    numbers = {"Samples", "Error", "Depth"}
    seen = {}
    for key, button in enumerate(page.tab.locator("#layers button").all(), start=1):
        name = button.inner_text()
        page.tab.locator("#picture").press(str(key))
        pressed = "document.querySelector('[aria-pressed=true][data-layer]')"
        page.wait(f"name => {pressed}.dataset.layer === name", name)
        if name == "Denoised":
            assert page.tab.locator("#filter").input_value() == "auto"
            page.wait_for_samples(4)
        title = {
            "Beauty": "radiance", "Denoised": "after the filter", "Samples": "samples per pixel",
            "Error": "error of the radiance", "Albedo": "reflectance", "Normal": "normal",
            "Depth": "distance",
        }[name]
        page.wait("part => title.textContent.includes(part)", title)
        assert page.tab.locator("#legend").is_visible() == (name in numbers), name
        seen[name] = page.pixels()
        page.screenshot(f"layer-{name.lower()}")
    assert len(seen) == 7
    assert len({bytes(pixels) for pixels in seen.values()}) == 7, "no two layers are the same"


def test_choices_begin_another_render(visit):
    page = visit()
    page.wait_for_samples(2)
    page.tab.locator("#width").select_option("160")
    page.wait("picture.width === 160")
    for control, choice in [
        ("allocator", "uniform"), ("estimator", "halves"), ("integrator", "lvc"),
        ("filter", "nlm"), ("scene", "daylight"),
    ]:
        page.tab.evaluate("document.documentElement.dataset.samples = 0")
        page.tab.locator(f"#{control}").select_option(choice)
        page.wait_for_samples(1)
        assert page.tab.locator("#problem").is_hidden(), choice
    page.tab.locator("#width").select_option("320")
    page.wait("picture.width === 320")


def test_a_render_ends_at_its_samples_and_can_be_paused(visit):
    page = visit()
    page.tab.locator("#width").select_option("160")
    page.tab.locator("#samples").select_option("16")
    page.wait("document.getElementById('status').textContent.endsWith('done')")
    assert page.samples() >= 16
    page.tab.locator("#samples").select_option("")
    page.wait_for_samples(1)
    page.tab.locator("#picture").press("Space")
    page.tab.wait_for_timeout(600)
    before = page.samples()
    page.tab.wait_for_timeout(600)
    assert page.samples() == before
    page.tab.locator("#picture").press("Space")
    page.wait_for_samples(before + 1)


def test_keys_turn_the_camera_and_put_it_back(visit):
    page = visit()
    page.tab.locator("#width").select_option("160")
    page.tab.locator("#samples").select_option("16")
    done = "picture.width === 160 && document.getElementById('status').textContent.endsWith('done')"
    page.wait(done)
    first = page.pixels()
    page.watch()
    for key in CAMERA_KEYS:
        page.tab.locator("#picture").press(key)
    page.wait("seen.restarted")
    page.wait(done)
    assert page.pixels() != first
    page.watch()
    page.tab.locator("#picture").press("r")
    page.wait("seen.restarted")
    page.wait(done)
    assert page.pixels() == first, "the same camera makes the same picture"


def test_a_drag_turns_the_camera_and_a_click_asks_for_the_pixel(visit):
    page = visit()
    page.wait_for_samples(2)
    box = page.tab.locator("#picture").bounding_box()
    middle = (box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    page.tab.mouse.click(*middle)
    page.wait("pixel.textContent.includes('radiance')")
    assert "pixel" in page.tab.locator("#pixel").inner_text()
    page.wait_for_samples(4)
    page.watch()
    page.tab.mouse.move(*middle)
    page.tab.mouse.down()
    page.tab.mouse.move(middle[0] + 60, middle[1] + 20, steps=5)
    # While the camera moves, a picture has one sample a pixel.
    page.wait("seen.fewest <= 1")
    page.tab.mouse.up()
    page.wait("picture.width === 320")
    page.wait_for_samples(2)


def test_all_controls_are_reached_by_the_keyboard(visit):
    page = visit()
    page.wait_for_samples(1)
    reached = set()
    for _ in range(40):
        page.tab.keyboard.press("Tab")
        reached.add(page.tab.evaluate("document.activeElement.id"))
    controls = page.tab.locator("select, input, canvas[tabindex], button[id]").all()
    wanted = {control.get_attribute("id") for control in controls if control.is_visible()}
    assert wanted and wanted <= reached


def test_a_narrow_screen_needs_no_scrolling_to_the_side(visit):
    page = visit(viewport={"width": 360, "height": 740}, has_touch=True)
    page.wait_for_samples(2)
    assert not page.is_wider_than_the_screen()
    page.screenshot("narrow")


def test_a_page_in_a_dark_room_is_dark(visit):
    page = visit(color_scheme="dark")
    page.wait_for_samples(2)
    ground = page.tab.evaluate("getComputedStyle(document.body).backgroundColor")
    assert max(map(int, ground[4:-1].split(","))) < 64
    page.screenshot("dark")


def test_without_webgpu_the_page_renders_all_the_same(visit, plain_browser):
    page = visit(plain_browser)
    assert page.tab.evaluate("navigator.gpu?.requestAdapter().then(Boolean) ?? false") is False
    # Chromium says on the console that there is none, since it was asked.
    page.complaints = [said for said in page.complaints if said != "No available adapters."]
    page.wait_for_samples(4)
    assert page.colors() > 1000


def test_what_is_loaded_is_below_five_megabytes(visit, address):
    sizes = {}
    page = visit()
    page.wait_for_samples(1)
    for url in {url for url in page.requests if url.startswith(address)}:
        sizes[url] = len(page.context.request.get(url).body())
    print(f"{sum(sizes.values()) / 1e6:.2f} MB: {sizes}")
    assert sum(sizes.values()) < 5_000_000
