"""Text that comes from outside of a job file (names of files, faces and pieces): on one line, of letters that show."""

UNSHOWN = "?"


def plain(text: str) -> str:
    """Return the text with a question mark for each letter that a terminal would act on or that no file holds."""
    return text if text.isprintable() else "".join(letter if letter.isprintable() else UNSHOWN for letter in text)


def plain_lines(text: str) -> str:
    """Return the same of several lines."""
    return "\n".join(map(plain, text.split("\n")))
