"""Somebody who reads the method on the page, step by step."""

# Of each picture that is shown: its size, and how many colours it has.
CANVASES = "#stage-pictures figure > canvas"
PICTURES = f"() => [...document.querySelectorAll('{CANVASES}')]" + """.map((canvas) => {
  const { width, height } = canvas;
  const { data } = canvas.getContext('2d').getImageData(0, 0, width, height);
  const colors = new Set(new Uint32Array(data.buffer)).size;
  return { width, height, colors, title: canvas.getAttribute('aria-label') };
})"""


class Reader:
    """Somebody who reads the method on a page."""

    def __init__(self, page, width=64, timeout=30):
        self.page, self.tab, self.timeout = page, page.tab, timeout
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
        self.page.wait(what, round, self.timeout)

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
                "beside": self.tab.locator("#stage-beside").inner_text(),
                "same": self.tab.evaluate("document.getElementById('stage-beside').dataset.same"),
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
