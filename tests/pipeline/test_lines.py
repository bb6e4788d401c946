"""The lines of the terminal: which figures of a stage are shown, and that nothing is said twice."""

from pipeline.report.lines import step_line, trouble_lines
from pipeline.run import Step
from stages.model.report import Finding, Metric, StageReport

WARP = Metric("equivalent_warp_deg", 0.031, "deg", limit=0.1)
STRAIN = Metric("max_strain", 2e-6, "", limit=1e-4)
NOISE = Metric("mesh_noise", 1.5e-7, "mm")


def test_a_mesh_that_was_judged_shows_warp_strain_and_noise() -> None:
    report = StageReport("verify", "shell", (WARP, STRAIN, NOISE), (), {"class": "fabrication"})
    assert step_line(Step("pass", report)) == (
        "shell  verify  fabrication  equivalent warp 0.031 deg  strain 2e-06  noise 1.5e-07 mm"
    )


def test_noise_that_is_not_known_is_not_shown() -> None:
    report = StageReport("verify", "shell", (WARP, STRAIN, Metric("mesh_noise", None, "mm")), (), {"class": "metal"})
    assert "noise" not in step_line(Step("pass", report))


def test_the_warp_of_a_refused_mesh_is_told_once() -> None:
    told = Finding("not-developable", "equivalent warp 0.5 deg, allowed 0.1 deg", True)
    report = StageReport("verify", "shell", (Metric("equivalent_warp_deg", 0.5, "deg", limit=0.1),), (told,))
    (line,) = trouble_lines(report)
    assert line.startswith("  equivalent warp 0.5 deg")
