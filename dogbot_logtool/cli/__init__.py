"""The command line: words in, one function called, results printed, an exit code set.

A command's module is loaded when it is called, so that --help answers at once.
"""

import errno
import os
import sys
from typing import NoReturn

import click

from dogbot_logtool import __version__
from dogbot_logtool.errors import LogtoolError
from dogbot_logtool.io.printable import printable, safe_streams
from dogbot_logtool.io.storage import valid_unicode, without_secrets
from dogbot_logtool.option import instead_of
from dogbot_logtool.options import COMMANDS, record_of
from dogbot_logtool.signals import stopped


class _Commands(click.Group):
    """Commands by name, each made when it is called or listed."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """See `click.Group`."""
        del ctx
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """See `click.Group`."""
        del ctx
        from dogbot_logtool.cli.command import command  # noqa: PLC0415

        return command(record_of(cmd_name)) if cmd_name in COMMANDS else None


@click.group(
    cls=_Commands,
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100},
)
@click.version_option(__version__, prog_name="dogbot-logtool")
def cli() -> None:
    """See and measure a legged robot's footfalls from recorded logs.

    LOG is a ROS 1 bag, a ROS 2 bag or an MCAP; a directory or glob of them; @FILE, a list of them;
    or a URL (s3://, gs://, http:// ...). Results go to stdout, everything else to stderr.

    Exit codes: 0 done; 1 it could not be done, or a difference or a broken rule was found; 2 the
    call was wrong; 3 done, but the input was damaged.
    """


def main() -> NoReturn:
    """Run the command line; every failure ends as a sentence and an exit code."""
    with safe_streams() as stdout:
        code = _run()
        sys.stdout.flush()
        if stdout.error is not None:
            is_closed = stdout.error.errno == errno.EBADF
            why = "it is closed" if is_closed else stdout.error.strerror
            say(f"stdout cannot be written: {why}")
            code = 1
    sys.exit(code)


def _run() -> int:
    """Run the command that was called; return its exit code."""
    code = 0
    try:
        # On Windows click would take the globs of --topics and --ignore for files.
        cli.main(standalone_mode=False, windows_expand_args=False)
    except SystemExit as ended:
        code = ended.code if isinstance(ended.code, int) else 0
    except Exception as error:  # noqa: BLE001 - a fault of ours is shown as a whole, on a stream that is safe
        # Python and libraries may make another error of the one that a signal raised.
        code = 1 if stopped() else _show(error)
    if code and (interruption := stopped()):
        click.echo("interrupted: nothing was left behind", err=True)
        code = interruption.exit_code
    return code


def _show(error: Exception) -> int:
    """Print an error; return its exit code."""
    if isinstance(error, click.ClickException):
        _explained(error).show()
        return error.exit_code
    if isinstance(error, LogtoolError):
        say(str(error))
        return error.exit_code
    _show_fault(error)
    return 1


def _explained(error: click.ClickException) -> click.ClickException:
    """Return an error that says what to use instead, if an option is gone; else the same error."""
    if isinstance(error, click.NoSuchOption) and error.ctx is not None:
        instead = instead_of(error.option_name, error.ctx.info_name or "")
        if instead is not None:
            return click.UsageError(f"{error.option_name} is gone: {instead}.", error.ctx)
    return error


def _show_fault(error: Exception) -> None:
    if isinstance(error, MemoryError):
        # Modules that print other sentences may not be loaded yet, and would take some.
        click.echo("error: there is not enough memory; with --jobs 1 the least is needed", err=True)
    elif isinstance(error, FileNotFoundError) and _has_no_directory():
        click.echo("error: the current directory was removed; change to another one", err=True)
    else:
        import traceback  # noqa: PLC0415 - a fault of ours is rare

        traceback.print_exception(error)


def _has_no_directory() -> bool:
    """Tell whether the current directory was removed, so that relative paths lead nowhere."""
    try:
        os.getcwd()  # noqa: PTH109 - the same as Path.cwd(), without its import
    except FileNotFoundError:
        return True
    return False


def say(sentence: str) -> None:
    """Print the sentence of an error."""
    from dogbot_logtool.report.text.console import diagnostics, print_error  # noqa: PLC0415

    print_error(diagnostics(), without_secrets(sentence))


def say_damage(sentence: str) -> None:
    """Print what was lost of a log: one line, whatever the names in it."""
    from dogbot_logtool.report.text.console import diagnostics, print_sentence  # noqa: PLC0415

    text = printable(without_secrets(valid_unicode(sentence)))
    print_sentence(diagnostics(), ("damage: ", "red"), text)


def note(sentence: str) -> None:
    """Print what is good to know."""
    from dogbot_logtool.report.text.console import diagnostics, print_note  # noqa: PLC0415

    print_note(diagnostics(), sentence)
