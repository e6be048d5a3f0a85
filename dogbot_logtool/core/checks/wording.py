"""Words that several findings share."""

from dogbot_logtool.finding import counted

__all__ = ["counted"]
