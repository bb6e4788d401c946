"""Which tests are asked: those of the same name first, then whoever imports the module, by any way."""

from pathlib import Path

import pytest

from tests.mutants.chosen import chosen_for, distances, importers

FILES = {
    "stages/a/core.py": "import math\n",
    "stages/a/upper.py": "from stages.a import core\n",
    "pipeline/top.py": "def f():\n    from stages.a.upper import g\n",
    "pipeline/late.py": 'WHERE = ("stages.a.core", "name")\n',
    "tests/stages/a/test_core.py": "import json\n",
    "tests/stages/a/test_core_more.py": "from stages.a.core import x\n",
    "tests/stages/a/test_upper.py": "from stages.a.upper import g\n",
    "tests/pipeline/test_top.py": "import pipeline.top\n",
    "tests/pipeline/test_late.py": "from pipeline.late import WHERE\n",
    "tests/pipeline/test_other.py": "import math\n",
    "tests/bench/test_core.py": "from stages.a.core import x\n",
}


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    for name, text in FILES.items():
        file = tmp_path / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text, "utf-8")
    return tmp_path


def test_the_likeliest_come_first_and_who_cannot_notice_does_not_come(tree: Path) -> None:
    assert chosen_for(tree, importers(tree), "stages/a/core.py") == [
        "tests/stages/a/test_core_more.py",
        "tests/stages/a/test_core.py",
        "tests/stages/a/test_upper.py",
        "tests/pipeline/test_late.py",
        "tests/pipeline/test_top.py",
    ]


def test_imports_are_counted_over_functions_and_texts(tree: Path) -> None:
    away = distances(importers(tree), "stages/a/core.py")
    assert (away["stages/a/upper.py"], away["pipeline/late.py"], away["pipeline/top.py"]) == (1, 1, 2)
    assert "tests/pipeline/test_other.py" not in away
