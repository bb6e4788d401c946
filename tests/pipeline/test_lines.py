"""The lines of the terminal: which figures of a stage are shown, and that nothing is said twice."""

from pathlib import Path

from pipeline.report.lines import REMEDIES, step_line, trouble_lines
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


def test_what_is_true_or_false_is_told_so_with_what_it_must_be() -> None:
    report = StageReport("verify", "shell", (Metric("regular", False, limit=True),), ())
    (line,) = trouble_lines(report)
    assert line == f"  regular is false, must be true; {REMEDIES['regular']}"


def test_a_remedy_is_that_of_a_metric_or_a_finding_that_there_is() -> None:
    texts = "".join(file.read_text("utf-8") for file in (Path(__file__).parents[2] / "stages").glob("**/*.py"))
    assert [name for name in REMEDIES if f'"{name}"' not in texts] == []


def test_a_strain_past_its_limit_is_told_once() -> None:
    told = Finding("bend-strain", "the outer fibre stretches by 30.000%, the material allows 25.000%", True)
    report = StageReport("verify", "bow", (Metric("outer_fibre_strain", 0.3, limit=0.25),), (told,))
    (line,) = trouble_lines(report)
    assert line == f"  {told.message}; {REMEDIES['bend-strain']}"
