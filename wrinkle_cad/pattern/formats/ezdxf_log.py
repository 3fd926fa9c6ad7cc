"""What ezdxf would tell the user's screen, kept from it: we say what matters in our own words."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def without_ezdxf_log(about: str = "") -> Iterator[None]:
    """Keeps ezdxf's messages that contain a text, all of them by default, from every log.

    Where nobody has set up logging, Python prints them to the standard error.

    Args:
        about: a part of the messages to be left out.
    """

    def tells_more(record: logging.LogRecord) -> bool:
        return about not in record.getMessage()

    logger = logging.getLogger("ezdxf")
    logger.addFilter(tells_more)
    try:
        yield
    finally:
        logger.removeFilter(tells_more)
