"""The same DXF bytes for the same pieces: fixes what ezdxf writes from the clock and at random."""

from __future__ import annotations

import re
import uuid
from datetime import datetime
from typing import Final

import ezdxf
from ezdxf.tools.juliandate import juliandate

EPOCH: Final = datetime(1970, 1, 1)
"""The time in a file when the caller gives none: the library never looks at a clock."""

_TIMES: Final = ("$TDCREATE", "$TDUCREATE", "$TDUPDATE", "$TDUUPDATE")
_GUIDS: Final = ("$FINGERPRINTGUID", "$VERSIONGUID")
_MARKER: Final = re.compile(re.escape(ezdxf.__version__) + r" @ \d{4}-\d\d-\d\dT\S+")


def stamped(text: str, timestamp: datetime) -> str:
    """Returns DXF text with every time in it ``timestamp`` and every GUID made of it.

    Args:
        text: tagged DXF, group codes and values on lines in turn.
        timestamp: what the file says about when it was made.
    """
    lines = _MARKER.sub(f"{ezdxf.__version__} @ {timestamp.isoformat()}", text).split("\n")
    julian = repr(juliandate(timestamp))
    guid = "{" + str(uuid.uuid5(uuid.NAMESPACE_OID, timestamp.isoformat())).upper() + "}"
    for i in range(0, len(lines) - 3, 2):
        if lines[i].strip() == "9" and lines[i + 1] in _TIMES:
            lines[i + 3] = julian
        elif lines[i].strip() == "9" and lines[i + 1] in _GUIDS:
            lines[i + 3] = guid
        elif lines[i + 1] == "ENDSEC":
            break
    return "\n".join(lines)
