"""What a STOP says of itself: whoever may stop the rig does, however odd the words that come along."""

import json
import re
from typing import Any

from pydantic import TypeAdapter, ValidationError

from rigkit.service.requests import Name, Reason

WHO, WHY = "somebody", "stopped"
"""Where a STOP does not say."""
DESCRIPTION: dict[str, Any] = {
    "requestBody": {
        "required": False,
        "description": "Words for the event log. What cannot be read is left out, and the rig stops all the same.",
        "content": {
            "application/json": {
                "schema": {
                    "type": "object",
                    "properties": {
                        "who": {"description": "who stops: text, kept to 60 characters", "default": WHO},
                        "why": {"description": "why: text, kept to 200 characters", "default": WHY},
                    },
                },
                "example": {"who": "Ada", "why": "smoke"},
            }
        },
    }
}
"""Of the body, for the published description: it has no form that is refused."""
_UNPRINTABLE = re.compile(r"[\x00-\x1f\x7f\ud800-\udfff]")
_LONGEST = {"who": 60, "why": 200}
_FORMS: dict[str, TypeAdapter[str]] = {"who": TypeAdapter(Name), "why": TypeAdapter(Reason)}


def who_and_why(body: bytes) -> tuple[str, str]:
    """Return who stops and why, from a body of any kind.

    Parameters
    ----------
    body : bytes
        Ideally JSON, `{"who": ..., "why": ...}`.  Text that is too long is cut, and characters that no log shows become
        "?"; what is no text, or is not there, is "somebody" and "stopped".
    """
    try:
        given = json.loads(body)
    except (ValueError, RecursionError):
        given = None
    fields = given if isinstance(given, dict) else {}
    return _text(fields, "who") or WHO, _text(fields, "why") or WHY


def _text(fields: dict[str, Any], name: str) -> str:
    value = fields.get(name)
    if not isinstance(value, str):
        return ""
    try:
        return _FORMS[name].validate_python(_UNPRINTABLE.sub("?", value[: _LONGEST[name]]).strip())
    except ValidationError:
        return ""
