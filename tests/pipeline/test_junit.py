"""junit.xml: a suite a part, a case a metric, in the order that the schemas ask for."""

import json
import re

import pytest
from lxml import etree

from pipeline.report.entries import entries
from pipeline.report.junit import junit_xml
from tests.pipeline.reports import JOBS, Report, changed, made, numbers

GRAMMAR = """\
<xs:schema xmlns:xs="http://www.w3.org/2001/XMLSchema">
 <xs:complexType name="told" mixed="true">
  <xs:attribute name="message" type="xs:string" use="required"/><xs:attribute name="type" type="xs:string"/>
 </xs:complexType>
 <xs:complexType name="case"><xs:sequence>
   <xs:choice minOccurs="0"><xs:element name="skipped"/><xs:element name="failure" type="told"/></xs:choice>
   <xs:element name="system-out" type="xs:string" minOccurs="0"/>
  </xs:sequence>
  <xs:attribute name="name" type="xs:string" use="required"/>
  <xs:attribute name="classname" type="xs:string" use="required"/>
 </xs:complexType>
 <xs:complexType name="properties"><xs:sequence>
  <xs:element name="property" maxOccurs="unbounded"><xs:complexType>
   <xs:attribute name="name" type="xs:string" use="required"/>
   <xs:attribute name="value" type="xs:string" use="required"/>
  </xs:complexType></xs:element>
 </xs:sequence></xs:complexType>
 <xs:attributeGroup name="counts">
  <xs:attribute name="name" type="xs:string" use="required"/>
  <xs:attribute name="tests" type="xs:nonNegativeInteger" use="required"/>
  <xs:attribute name="failures" type="xs:nonNegativeInteger" use="required"/>
  <xs:attribute name="errors" type="xs:nonNegativeInteger" use="required"/>
 </xs:attributeGroup>
 <xs:complexType name="suite"><xs:sequence>
   <xs:element name="properties" type="properties" minOccurs="0"/>
   <xs:element name="testcase" type="case" minOccurs="0" maxOccurs="unbounded"/>
   <xs:element name="system-out" type="xs:string" minOccurs="0"/>
  </xs:sequence>
  <xs:attributeGroup ref="counts"/>
  <xs:attribute name="skipped" type="xs:nonNegativeInteger" use="required"/>
  <xs:attribute name="id" type="xs:nonNegativeInteger" use="required"/>
 </xs:complexType>
 <xs:element name="testsuites"><xs:complexType><xs:sequence>
   <xs:element name="testsuite" type="suite" maxOccurs="unbounded"/>
  </xs:sequence><xs:attributeGroup ref="counts"/></xs:complexType></xs:element>
</xs:schema>
"""
"""What the schemas of Jenkins and of Ant have in common, but for the clock that the latter asks for."""


def valid(content: bytes) -> etree._Element:
    root = etree.fromstring(content)
    etree.XMLSchema(etree.fromstring(GRAMMAR)).assertValid(root)
    return root


def suite(report: Report, name: str) -> etree._Element:
    (found,) = (one for one in valid(junit_xml(report)) if one.get("name") == name)
    return found


@pytest.mark.parametrize("name", JOBS)
def test_the_document_is_valid_and_counts_right(name: str) -> None:
    report, files = made(name)
    root = valid(files["junit.xml"])
    read = entries(report)
    assert [one.get("name") for one in root] == [*(part.name for part in read.parts), read.job.name]
    for one in (root, *root):
        assert one.get("tests") == str(len(list(one.iter("testcase"))))
        assert one.get("failures") == str(len(list(one.iter("failure"))))
    assert (root.get("failures") == "0") == (report["status"] == "made")


@pytest.mark.parametrize("name", JOBS)
def test_every_metric_is_a_case_and_no_two_are_called_alike(name: str) -> None:
    report, files = made(name)
    cases = [(one.get("classname"), one.get("name")) for one in valid(files["junit.xml"]).iter("testcase")]
    assert len(set(cases)) == len(cases)
    for part in entries(report).parts:
        for stage in part.stages:
            assert {(f"{part.name}.{stage.stage}", metric.name) for metric in stage.metrics} <= set(cases)


NUMBER = re.compile(r"(?<![\w.])-?\d+(?:\.\d+)?(?:e[+-]?\d+)?(?![\w.])")


@pytest.mark.parametrize("name", JOBS)
def test_no_number_of_a_case_is_not_in_the_report(name: str) -> None:
    report, files = made(name)
    known = numbers(report)
    messages = json.dumps(report)
    texts = [str(one.text) for one in valid(files["junit.xml"]).iter("system-out", "failure")]
    told = [found for text in texts for found in NUMBER.findall(text)]
    assert told or name != "nested"
    assert [one for one in told if float(one) not in known and one not in messages] == []


METRIC = {"name": "max_warp_deg", "value": 0.3, "unit": "deg", "evidence": "proved", "limit": 0.1, "where": None}
STAGE = {"stage": "verify", "status": "fail", "findings": []}


def failing(report: Report) -> Report:
    return changed(report, [{**STAGE, "metrics": [{**METRIC, "pass": False}]}], "parts", 0, "stages")


def test_a_metric_past_its_limit_is_a_failure_with_both_numbers() -> None:
    report, _ = made("flat only")
    (case,) = suite(failing(report), "plate").iter("testcase")
    (failure,) = case.iter("failure")
    assert failure.get("message") == "max_warp_deg: 0.3 deg, limit 0.1 deg, proved"
    assert suite(report, "plate").get("failures") == "0"


def test_fatal_findings_are_failures_and_others_are_output() -> None:
    report, _ = made("flat only")
    findings = [{"code": code, "message": f"of {code}", "fatal": code != "c", "where": {}} for code in "aabc"]
    found = suite(changed(report, [{**STAGE, "metrics": [], "findings": findings}], "parts", 0, "stages"), "plate")
    assert [(one.get("type"), one.text) for one in found.iter("failure")] == [("a", "of a\nof a"), ("b", "of b")]
    assert found.findtext("system-out") == "verify: c: of c"


def test_a_stage_that_failed_without_a_number_or_finding_is_a_failure() -> None:
    report, _ = made("flat only")
    failed = changed(report, [{**STAGE, "metrics": []}], "parts", 0, "stages")
    assert suite(failed, "plate").get("failures") == "1"


def test_stages_that_were_not_reached_are_skipped() -> None:
    report, _ = made("rejected")
    found = suite(report, "twisted")
    assert [one.getparent().get("classname") for one in found.iter("skipped")] == ["twisted.unroll"]
    assert found.get("skipped") == "1"


@pytest.mark.parametrize("name", ["<script>", "\"q\" & 'a'", "Größe ß 型", "n" * 300, "a\nb\tc"])
def test_names_come_back(name: str) -> None:
    report, _ = made("flat only")
    root = valid(junit_xml(changed(report, name, "parts", 0, "name")))
    assert root[0].get("name") == name


def test_what_xml_forbids_is_replaced_and_told() -> None:
    report, _ = made("flat only")
    root = valid(junit_xml(changed(report, "a\x00b\x1b\ufffe", "parts", 0, "name")))
    assert root[0].get("name") == "a\ufffdb\ufffd\ufffd"
    told = root[0].findtext("system-out")
    assert told is not None
    assert [line[:6] for line in told.splitlines()] == ["U+0000", "U+001B", "U+FFFE"]


def test_a_document_without_such_characters_tells_of_none() -> None:
    _, files = made("flat only")
    assert b"no character of XML" not in files["junit.xml"]
