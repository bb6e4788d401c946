"""What is drawn in a DXF document: of a pattern file the content of its blocks, of any other the model space."""

from collections.abc import Iterator, Mapping

from ezdxf.document import Drawing as Document
from ezdxf.entities.dxfentity import DXFEntity
from ezdxf.entities.insert import Insert

from stages.model.cutfile import Layer
from stages.model.patternlayers import POINTS_ONLY, VALIDATION, is_pattern_profile

SAID = POINTS_ONLY | frozenset(VALIDATION.values())
"""The layers of what is said of lines besides themselves: `readpieces` reads it."""


def drawn(document: Document, layers: Mapping[str, Layer]) -> Iterator[DXFEntity]:
    """Yield the entities of a document, where `layers` are those of a pattern file, blocks in place of their names.

    How a block is inserted is not looked at: one that is turned or moved is a fault that is found elsewhere.
    """
    for entity in document.modelspace():
        if not (isinstance(entity, Insert) and is_pattern_profile(layers) and entity.dxf.name in document.blocks):
            yield entity
            continue
        yield from (one for one in document.blocks[entity.dxf.name] if one.dxf.layer not in SAID)
