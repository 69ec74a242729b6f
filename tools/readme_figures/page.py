"""The pictures of the page."""
from comparison.simulator import ROOT
from readme_figures.registry import Cost, entry

STATIC = ROOT / "tools/python/steadystep/page/static"


def what_is_drawn(_):
    return "".join(path.read_text(encoding="utf-8") for path in sorted(STATIC.iterdir()))


def pictured(name):
    @entry(f"picture-{name}", "tools/page_pictures", Cost.CAMPAIGN, probe=(what_is_drawn,), picture=f"{name}.png")
    def draw(sources):
        sources.tool("page_pictures", sources.program)
        return {}
    return draw


pictured("page")
pictured("page-narrow")
