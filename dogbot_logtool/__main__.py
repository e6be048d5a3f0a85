"""``python -m dogbot_logtool`` is the command ``dogbot-logtool``."""

from dogbot_logtool.cli import main

if __name__ == "__main__":
    main()
