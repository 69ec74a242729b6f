"""A headless Chromium on the page of a simulated drive. Exits with 77, skipped, where there is none."""
import contextlib
import pathlib
import shutil
import sys

from operated import ROOT

SKIPPED = 77
BROWSER = ROOT / "build" / "browser"
sys.path.insert(0, str(BROWSER))

CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)

try:
    from playwright.sync_api import expect, sync_playwright
except ImportError:
    sync_playwright = None

if sync_playwright is None or CHROMIUM is None:
    print("no Chromium or no Playwright: tools/setup browser installs both")
    sys.exit(SKIPPED)

expect.set_options(timeout=20000)
WIDE, NARROW = {"width": 1300, "height": 900}, {"width": 400, "height": 850}


@contextlib.contextmanager
def opened(address, remarks):
    """The page in a browser that reaches nothing else; what it complains of goes to `remarks`."""
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        # the page allows no script but its own, which is what a test's questions are
        context = browser.new_context(viewport=WIDE, bypass_csp=True, accept_downloads=True)
        context.route("**/*", lambda route: route.continue_() if "//127.0.0.1:" in route.request.url
                      else (remarks.append(f"asked for {route.request.url}"), route.abort()))
        tab = context.new_page()
        tab.on("console", lambda said: remarks.append(said.text) if said.type == "error" else None)
        tab.on("pageerror", lambda error: remarks.append(str(error)))
        tab.goto(address)
        expect(tab.locator("#state")).not_to_have_text("…")
        yield tab
        browser.close()


def screenshot(tab, path):
    pathlib.Path(path).parent.mkdir(parents=True, exist_ok=True)
    tab.screenshot(path=str(path))
