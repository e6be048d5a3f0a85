"""The command line: words in, one function called, results printed, an exit code set.

One file a command. Commands import what they need when they run, so that --help answers at once.
"""

import os
import sys
from typing import NoReturn

import click

from dogbot_logtool import __version__
from dogbot_logtool.cli.compare import compare
from dogbot_logtool.cli.convert import convert
from dogbot_logtool.cli.info import info
from dogbot_logtool.cli.layout import layout
from dogbot_logtool.cli.outcomes import say_error
from dogbot_logtool.cli.report import report
from dogbot_logtool.cli.robots import robots
from dogbot_logtool.cli.stats import stats
from dogbot_logtool.errors import LogtoolError
from dogbot_logtool.signals import Stopped, raise_on_signals


@click.group(context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100})
@click.version_option(__version__, prog_name="dogbot-logtool")
def cli() -> None:
    """See and measure a legged robot's footfalls from recorded logs.

    LOG is a ROS 1 bag, a ROS 2 bag or an MCAP; a directory or glob of them; @FILE, a list of them;
    or a URL (s3://, gs://, http:// ...). Results go to stdout, everything else to stderr.

    Exit codes: 0 done; 1 it could not be done, or a difference was found; 2 the call was wrong;
    3 done, but the input was damaged.
    """


for _command in (info, convert, stats, report, compare, layout, robots):
    cli.add_command(_command)


def main() -> NoReturn:
    """Run the command line; every failure ends as a sentence and an exit code."""
    raise_on_signals()
    # numpy's linear algebra, which we do not use, starts threads that burn 0.1 s of every core, and
    # a process with threads is ill copied.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    try:
        cli.main(standalone_mode=False)
    except Stopped:
        click.echo("interrupted: nothing was left behind", err=True)
        raise
    except click.ClickException as error:
        error.show()
        sys.exit(error.exit_code)
    except LogtoolError as error:
        say_error(error)
        sys.exit(error.exit_code)
    except BrokenPipeError:
        # Whoever read our output has seen enough.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        sys.exit(0)
    sys.exit(0)
