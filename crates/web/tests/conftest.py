"""The page in a real browser, served as `cargo page` serves it.

Before: `cargo page --no-serve` and `cargo test --release`, which builds the example `digests`, or
`cargo build --release -p raystream-web --example digests`, which is enough.
CHROMIUM names another browser than Debian's, SCREENSHOTS a folder to write screenshots to.
"""

import os
import pathlib
import shutil
import subprocess

import pytest
from playwright.sync_api import sync_playwright

ROOT = pathlib.Path(__file__).parents[3]
# A software device for WebGPU; browsers hide it unless they are told otherwise.
WEBGPU = ["--enable-unsafe-webgpu", "--use-webgpu-adapter=swiftshader"]


@pytest.fixture(scope="session")
def address():
    """Where the page is served."""
    command = ["cargo", "page", "--no-build", "--port", "0"]
    server = subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, text=True)
    try:
        yield server.stdout.readline().strip()
    finally:
        server.terminate()
        server.wait()


@pytest.fixture(scope="session")
def playwright():
    with sync_playwright() as started:
        yield started


def launch(playwright, flags):
    executable = os.environ.get("CHROMIUM") or shutil.which("chromium")
    assert executable, "install Debian's package chromium, or name a browser by CHROMIUM"
    # Root, as in a container, has no sandbox.
    return playwright.chromium.launch(executable_path=executable, args=["--no-sandbox", *flags])


@pytest.fixture(scope="session")
def browser(playwright):
    """With WebGPU, by a software device."""
    browser = launch(playwright, WEBGPU)
    yield browser
    browser.close()


@pytest.fixture(scope="session")
def plain_browser(playwright):
    """Without WebGPU."""
    browser = launch(playwright, ["--disable-features=WebGPU", "--disable-gpu"])
    yield browser
    browser.close()


class Visit:
    """A page that is open, and what it has said on the console."""

    def __init__(self, browser, address, **options):
        self.context = browser.new_context(**options)
        self.tab = self.context.new_page()
        self.complaints = []
        self.tab.on("console", self._console)
        self.tab.on("pageerror", lambda error: self.complaints.append(str(error)))
        self.tab.on("requestfailed", lambda request: self.complaints.append(request.url))
        self.requests = []
        self.tab.on("request", lambda request: self.requests.append(request.url))
        self.tab.goto(address)

    def _console(self, message):
        if message.type in ("error", "warning"):
            self.complaints.append(message.text)

    def samples(self):
        """Samples a pixel of the picture that is shown; 0 before there is one."""
        return float(self.tab.evaluate("document.documentElement.dataset.samples ?? 0"))

    def wait(self, condition, argument=None, timeout=30):
        self.tab.wait_for_function(condition, arg=argument, timeout=1000 * timeout)

    def wait_for_samples(self, samples, timeout=30):
        condition = "least => Number(document.documentElement.dataset.samples ?? 0) >= least"
        self.wait(condition, samples, timeout)

    def watch(self):
        """Has `seen` say whether the picture is made anew from now on, and of how few samples it
        was: both may be over before anybody looks."""
        self.tab.evaluate(
            """() => {
              const status = document.getElementById('status');
              const { dataset } = document.documentElement;
              const seen = { fewest: Infinity, restarted: false };
              const observer = new MutationObserver(() => {
                seen.fewest = Math.min(seen.fewest, Number(dataset.samples));
                seen.restarted ||= !status.textContent.endsWith('done');
              });
              observer.observe(document.documentElement, { attributes: true });
              observer.observe(status, { childList: true, characterData: true, subtree: true });
              window.seen = seen;
            }"""
        )

    def colors(self):
        """How many colours there are in the picture."""
        return self.tab.evaluate(
            """() => {
              const { width, height } = picture;
              const { data } = picture.getContext('2d').getImageData(0, 0, width, height);
              return new Set(new Uint32Array(data.buffer)).size;
            }"""
        )

    def pixels(self):
        """All bytes of the picture."""
        return self.tab.evaluate(
            """() => {
              const { width, height } = picture;
              return [...picture.getContext('2d').getImageData(0, 0, width, height).data];
            }"""
        )

    def screenshot(self, name):
        folder = os.environ.get("SCREENSHOTS")
        if folder:
            self.tab.screenshot(path=pathlib.Path(folder) / f"{name}.png", full_page=True)

    def is_wider_than_the_screen(self):
        return self.tab.evaluate(
            "document.documentElement.scrollWidth > document.documentElement.clientWidth"
        )

    def close(self):
        self.context.close()
        assert self.complaints == []


@pytest.fixture
def visit(browser, address):
    """Opens the page; at the end nothing may have gone wrong on it."""
    visits = []

    def open_page(in_browser=browser, **options):
        visits.append(Visit(in_browser, address, **options))
        return visits[-1]

    yield open_page
    for opened in visits:
        opened.close()
