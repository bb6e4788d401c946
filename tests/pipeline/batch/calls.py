"""Commands called in the process of the test, as a user would type them."""

import pytest

from pipeline.cli import main


def call(*words: object) -> int:
    """Return the exit code of a command."""
    with pytest.raises(SystemExit) as ended:
        main([str(word) for word in words])
    return int(ended.value.code or 0)


def plain(*words: object) -> None:
    """Call a command that only tells something."""
    main([str(word) for word in words])
