"""The JSON Schema of `report.json`, as it is published: its version is that of the reports it describes.

What is added keeps the version as long as no reader of older reports breaks: keys are added, none is taken away or
changes its meaning.  Anything else is planish-report/2.
"""

from importlib.resources import files

FILE = "report-schema.json"


def report_schema() -> str:
    """Return the schema."""
    return files("pipeline").joinpath("data", FILE).read_text("utf-8").rstrip()
