"""The page on a GPU, by WebGPU: a software one here, which takes seconds to compile a kernel."""

import pathlib

from reader import Reader, names, numbers

PAGE = pathlib.Path(__file__).parents[1] / "page"
# Stages of integers alone, which are the same on every device.
EXACT = ["Weights", "Runs", "Slots", "Film after"]


def choose_gpu(page):
    """Computes on the GPU from now on, small and by the kernel that is compiled soonest."""
    page.tab.locator("#width").select_option("160")
    page.tab.locator("#integrator").select_option("megakernel")
    page.tab.locator("#computer").select_option("webgpu")
    page.wait("document.documentElement.dataset.device === 'webgpu'")


def device(page):
    return page.tab.locator("#device").inner_text()


def test_exact_stages_are_the_same_bytes_on_gpu_and_cpu(visit):
    page = visit()
    choose_gpu(page)
    reader = Reader(page, width=32, timeout=120)
    reader.press("n")
    reader.wait_for(2)
    reader.press("n")
    reader.wait_for(3)
    stages = reader.read_round(lambda: reader.tab.locator("#next").click())
    facts = numbers(stages)
    assert facts["slots"] == facts["budget"] == str(32 * 24)
    assert int(facts["samples-after"]) == int(facts["samples-before"]) + int(facts["slots"])
    assert facts["adds-up"].startswith("yes")
    beside = {stage["name"]: stage for stage in stages}
    for name in EXACT:
        assert beside[name]["same"] == "true", beside[name]["beside"]
    for name in names(stages)[1:]:
        assert "Kernels: " in beside[name]["beside"] and "CPU and GPU" in beside[name]["beside"]
    for stage in stages:
        print(stage["name"], stage["beside"])


def test_the_gpu_renders_what_the_cpu_renders(visit, address):
    """The same paths: where a device rounds otherwise few of them go another way. All that is
    loaded for both is below 5 MB."""
    page = visit()
    page.tab.locator("#allocator").select_option("uniform")
    page.tab.locator("#samples").select_option("16")
    pictures = {}
    done = "picture.width === 160 && document.getElementById('status').textContent.endsWith('done')"
    for name in ["webgpu", "cpu"]:
        if name == "webgpu":
            choose_gpu(page)
        else:
            page.tab.evaluate("document.getElementById('status').textContent = ''")
            page.tab.locator("#computer").select_option("cpu")
        page.wait(done, timeout=120)
        assert ("WebGPU" in device(page)) == (name == "webgpu")
        pictures[name] = page.pixels()
        page.screenshot(f"device-{name}")
    apart = [abs(a - b) for a, b in zip(pictures["cpu"], pictures["webgpu"])]
    print(f"{sum(1 for a in apart if a)} of {len(apart)} bytes differ")
    assert len(set(pictures["webgpu"])) > 100, "it is a picture"
    assert sum(apart) / len(apart) < 0.5
    urls = {url for url in page.requests if url.startswith(address)}
    sizes = {url: len(page.context.request.get(url).body()) for url in urls}
    assert any(url.endswith("kernels.json.gz") for url in sizes)
    print(f"{sum(sizes.values()) / 1e6:.2f} MB")
    assert sum(sizes.values()) < 5_000_000


def test_without_webgpu_the_page_says_so_and_takes_the_cpu(visit, plain_browser):
    page = visit(plain_browser)
    page.wait_for_samples(1)
    page.tab.evaluate("document.documentElement.dataset.samples = 0")
    page.tab.locator("#computer").select_option("webgpu")
    page.wait("document.getElementById('device').textContent.includes('There is no GPU')")
    assert "has found no GPU" in device(page) or "has no WebGPU" in device(page)
    assert page.tab.locator("#computer").input_value() == "cpu"
    page.wait_for_samples(1)
    # Chromium says on the console that there is none, since it was asked.
    page.complaints = [said for said in page.complaints if said != "No available adapters."]


def test_without_jspi_the_page_says_so_and_takes_the_cpu(visit):
    def without(route):
        script = (PAGE / "gpu.js").read_text()
        body = f"delete WebAssembly.Suspending;\n{script}"
        route.fulfill(body=body, content_type="text/javascript")

    page = visit()
    page.wait_for_samples(1)
    page.context.route("**/gpu.js", without)
    page.tab.reload()
    page.wait_for_samples(1)
    page.tab.locator("#computer").select_option("webgpu")
    page.wait("document.getElementById('device').textContent.includes('has no JSPI')")
    page.tab.evaluate("document.documentElement.dataset.samples = 0")
    page.wait_for_samples(1)
