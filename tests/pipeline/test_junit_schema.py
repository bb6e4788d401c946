"""junit.xml against the rules of the schemas that servers check by, written down one by one.

Jenkins: `junit-10.xsd` of its xUnit plugin [1]_.  Ant: the schema of its JUnit task as published by Windy Road [2]_, of
which the attributes that a clock or a host would fill (`time`, `timestamp`, `hostname`) and `package` are left out, and
`name` on the root, which Ant's converters ignore.

.. [1] jenkinsci/xunit-plugin, src/main/resources/org/jenkinsci/plugins/xunit/types/model/xsd/junit-10.xsd.
.. [2] windyroad/JUnit-Schema, JUnit.xsd.
"""

import copy
from collections.abc import Iterator
from typing import NamedTuple

import pytest
from lxml import etree

from tests.pipeline.reports import JOBS, made

OUTPUT = ("system-out", "system-err")
RERUN = ("rerunFailure", "rerunError", "flakyFailure", "flakyError")


class Rule(NamedTuple):
    """What an element may hold, and its attributes: those it must have, those it may have."""

    children: tuple[str, ...]
    must: frozenset[str]
    may: frozenset[str]
    text: bool = False


def rule(children: tuple[str, ...], must: str, may: str, *, text: bool = False) -> Rule:
    return Rule(children, frozenset(must.split()), frozenset(may.split()), text)


JENKINS = {
    "testsuites": rule(("testsuite",), "", "name time tests failures errors"),
    "testsuite": rule(("testsuite", "properties", "testcase", *OUTPUT), "name tests failures errors",
                      "group time skipped timestamp hostname id package file log url"),
    "properties": rule(("property",), "", ""),
    "property": rule((), "name value", ""),
    "testcase": rule(("skipped", "error", "failure", *RERUN, *OUTPUT), "name", "time classname group"),
    **dict.fromkeys(("failure", "error", "skipped"), rule((), "", "type message", text=True)),
    **dict.fromkeys(OUTPUT, rule((), "", "", text=True)),
}  # fmt: skip
ANT_ORDER = {
    "testsuites": ("testsuite",),
    "testsuite": ("properties", "testcase", *OUTPUT),
    "testcase": ("skipped", "error", "failure", *OUTPUT),
}
"""Ant's are sequences: what is there stands in this order."""
WHOLE_NUMBERS = frozenset(("tests", "failures", "errors", "skipped", "id"))


def broken(root: etree._Element) -> Iterator[str]:
    """Yield what stands against a document."""
    if root.tag != "testsuites":
        yield f"{root.tag} is no root"
    for element in root.iter():
        known = JENKINS.get(str(element.tag))
        if known is None:
            yield f"{element.tag} is no element"
            continue
        names = {str(name) for name in element.attrib}
        yield from (f"{element.tag} has no {name}" for name in known.must - names)
        yield from (f"{element.tag} has {name}" for name in names - known.must - known.may)
        yield from (f"{element.tag} holds {one.tag}" for one in element if one.tag not in known.children)
        if not known.text and (element.text or "").strip():
            yield f"{element.tag} holds text"
        yield from (f"{name} is no number" for name in names & WHOLE_NUMBERS if not str(element.get(name)).isdigit())
        order = ANT_ORDER.get(str(element.tag), ())
        places = [order.index(str(one.tag)) for one in element if one.tag in order]
        if places != sorted(places):
            yield f"{element.tag} is out of order"


@pytest.mark.parametrize("name", JOBS)
def test_a_document_keeps_the_rules_of_jenkins_and_the_order_of_ant(name: str) -> None:
    assert list(broken(etree.fromstring(made(name)[1]["junit.xml"]))) == []


def test_ant_wants_no_two_suites_of_an_id_and_a_class_for_every_case() -> None:
    root = etree.fromstring(made("nested")[1]["junit.xml"])
    assert [suite.get("id") for suite in root] == [str(number) for number in range(len(root))]
    assert all(case.get("classname") for case in root.iter("testcase"))


def spoilt(root: etree._Element) -> Iterator[tuple[str, etree._Element]]:
    """Yield documents with one thing wrong each, and what is to be said of it."""
    for place, attribute, said in (
        (".", "seconds", "testsuites has seconds"), ("testsuite", "limit", "testsuite has limit"),
        (".//testcase", "value", "testcase has value"),
    ):  # fmt: skip
        other = copy.deepcopy(root)
        other.find(place).set(attribute, "1")
        yield said, other
    for place, attribute in (("testsuite", "errors"), (".//testcase", "name")):
        other = copy.deepcopy(root)
        found = other.find(place)
        del found.attrib[attribute]
        yield f"{found.tag} has no {attribute}", other
    other = copy.deepcopy(root)
    etree.SubElement(other.find(".//testcase"), "metric")
    yield "testcase holds metric", other
    other = copy.deepcopy(root)
    other.find("testsuite").append(etree.Element("properties"))
    yield "testsuite is out of order", other
    other = copy.deepcopy(root)
    other.find("testsuite").set("tests", "many")
    yield "tests is no number", other


def test_each_rule_sees_what_breaks_it() -> None:
    for said, document in spoilt(etree.fromstring(made("nested")[1]["junit.xml"])):
        assert said in list(broken(document)), said
