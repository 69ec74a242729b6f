"""All entries, in the order in which they are run."""
from readme_figures import as_built, boards, campaigns, laws, link, overview, page, papers, sensorless, vibration  # noqa: F401
from readme_figures.registry import ENTRIES  # noqa: F401
