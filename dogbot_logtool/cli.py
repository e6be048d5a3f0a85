"""The command line: words in, one function called, results printed, an exit code set."""

import json
import os
import signal
import sys
from collections.abc import Callable
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING, Any, NoReturn, TypeVar

import click

from dogbot_logtool import __version__
from dogbot_logtool.errors import CallError, LogtoolError

if TYPE_CHECKING:
    from dogbot_logtool.selection import TopicOptions

# The commands' own modules are imported inside the commands, so that --help answers at once.
# ruff: noqa: PLC0415

_Command = TypeVar("_Command", bound=Callable[..., Any])
_LOGS = click.argument(
    "logs", nargs=-1, required=True, metavar="LOG...", type=click.Path(path_type=Path)
)
_JSON = click.option("--json", "as_json", is_flag=True, help="Print the result as JSON on stdout.")


def _quietness(command: _Command) -> _Command:
    command = click.option("-q", "--quiet", is_flag=True, help="Print results and errors only.")(
        command
    )
    return click.option("-v", "--verbose", is_flag=True, help="Print more of what was done.")(
        command
    )


def _topic_options(command: _Command) -> _Command:
    for option in (
        click.option("--mass", "mass_kg", type=float, metavar="KG", help="Mass of the robot."),
        click.option(
            "--foot",
            "feet",
            multiple=True,
            metavar="NAME=TOPIC",
            help="Contact topic of a foot; may be given several times.",
        ),
        click.option(
            "--odom-topic", metavar="TOPIC", help="Odometry topic, instead of the one found."
        ),
        click.option(
            "--robot",
            metavar="NAME|FILE.toml",
            help="Known robot or a robot's file; default: told by the log's topics.",
        ),
    ):
        command = option(command)
    return command


def _parse_topics(
    robot: str | None, odom_topic: str | None, feet: tuple[str, ...], mass_kg: float | None
) -> "TopicOptions":
    from dogbot_logtool.selection import TopicOptions

    foot_topics: dict[str, str] = {}
    for foot in feet:
        name, equals, topic = foot.partition("=")
        if not (name and equals and topic):
            raise CallError(f"--foot {foot}: must be NAME=TOPIC, such as front_left=/fl/contacts")
        if not name.replace("_", "").isalnum():
            raise CallError(f"--foot {foot}: a foot's name has letters, digits and _ only")
        foot_topics[name] = topic
    if mass_kg is not None and not 0 < mass_kg < 1e6:
        raise CallError(f"--mass {mass_kg}: must be a number of kilograms above 0")
    return TopicOptions(robot, odom_topic, foot_topics, mass_kg)


@click.group(context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100})
@click.version_option(__version__, prog_name="dogbot-logtool")
def cli() -> None:
    """See and measure a legged robot's footfalls from recorded logs.

    LOG is a ROS 1 bag or an MCAP. Results go to stdout, everything else to stderr.

    Exit codes: 0 done; 1 it could not be done, or a difference was found; 2 the call was wrong;
    3 done, but the input was damaged.
    """


@cli.command()
@_LOGS
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    metavar="OUT",
    help="File, or a directory for several logs; default: <log>.annotated.mcap here.",
)
@click.option(
    "--style",
    type=click.Choice(["classic", "pressure", "force"]),
    default="pressure",
    show_default=True,
    help="Arrows: as arrows_rviz.py drew them, load straight up, or the force itself.",
)
@click.option(
    "--encoding",
    type=click.Choice(["foxglove", "ros1"]),
    default="foxglove",
    show_default=True,
    help="Messages that are added: Foxglove's, or ROS 1 markers and transforms.",
)
@click.option(
    "--copy/--no-copy", default=True, show_default=True, help="Copy the recorded messages too."
)
@_topic_options
@click.option(
    "--wrench-frame",
    type=click.Choice(["auto", "world", "link"]),
    default="auto",
    show_default=True,
    help="Frame of the recorded wrenches; auto decides by evidence.",
)
@click.option(
    "--tf",
    type=click.Choice(["auto", "always", "never"]),
    default="auto",
    show_default=True,
    help="Write /tf; auto does not if the log places the base already.",
)
@click.option(
    "--tf-rate",
    type=click.FloatRange(min=0, max=1e6),
    default=50.0,
    show_default=True,
    metavar="HZ",
    help="Transforms a second; 0 writes every odometry message.",
)
@click.option("--start", "start_s", type=float, metavar="S", help="Seconds since the log's start.")
@click.option("--end", "end_s", type=float, metavar="S", help="Seconds since the log's start.")
@click.option(
    "--compression",
    type=click.Choice(["zstd", "lz4", "none"]),
    help="Of the output; default: zstd, and chunks copied from an MCAP as they are.",
)
@click.option(
    "--jobs",
    type=click.IntRange(min=1, max=256),
    help="Threads; default: as many as there are cores. The output is the same.",
)
@click.option("--overwrite", is_flag=True, help="Replace the output if it exists.")
@click.option("--strict", is_flag=True, help="Refuse damaged logs instead of salvaging them.")
@_JSON
@_quietness
def convert(
    logs: tuple[Path, ...],
    output: Path | None,
    robot: str | None,
    odom_topic: str | None,
    feet: tuple[str, ...],
    mass_kg: float | None,
    jobs: int | None,
    *,
    as_json: bool,
    quiet: bool,
    verbose: bool,
    **options: Any,  # noqa: ANN401 - click's words go straight into the dataclass
) -> None:
    """Write an annotated MCAP: /tf, an arrow and a load at each foot, and the log itself."""
    from dogbot_logtool.convert import convert as convert_log
    from dogbot_logtool.convert import targets
    from dogbot_logtool.plan import ConvertOptions
    from dogbot_logtool.report.console import diagnostics
    from dogbot_logtool.report.convert_report import conversion_json, print_conversion
    from dogbot_logtool.report.progress import progress_bar

    options["tf_rate_hz"] = options.pop("tf_rate")
    chosen = ConvertOptions(
        topics=_parse_topics(robot, odom_topic, feet, mass_kg), jobs=jobs or _cores(), **options
    )
    console = diagnostics()
    outcomes = _Outcomes()
    for source, target in targets(logs, output):
        with outcomes.of(source), progress_bar(console, source.name, shown=not quiet) as progress:
            done = convert_log(source, target, chosen, progress)
            outcomes.add(conversion_json(done), done.exit_code)
            if not quiet:
                print_conversion(console, done, verbose=verbose)
    outcomes.finish(as_json=as_json, single=len(logs) == 1)


@cli.command()
@_LOGS
@_topic_options
@_JSON
@_quietness
def info(
    logs: tuple[Path, ...],
    robot: str | None,
    odom_topic: str | None,
    feet: tuple[str, ...],
    mass_kg: float | None,
    *,
    as_json: bool,
    quiet: bool,
    verbose: bool,
) -> None:
    """Show what is in a log, what will be used for what, and what is wrong with it."""
    from dogbot_logtool.info import describe
    from dogbot_logtool.report.console import results
    from dogbot_logtool.report.info_report import info_json, print_info

    del quiet, verbose
    options = _parse_topics(robot, odom_topic, feet, mass_kg)
    outcomes = _Outcomes()
    for source in logs:
        with outcomes.of(source):
            found = describe(source, options)
            outcomes.add(info_json(found), found.exit_code)
            if not as_json:
                print_info(results(), found)
    outcomes.finish(as_json=as_json, single=len(logs) == 1)


@cli.command()
@click.argument("log", required=False, type=click.Path(path_type=Path))
@click.option(
    "-o", "--output", type=click.Path(path_type=Path), metavar="FILE", help="Default: stdout."
)
@click.option("--overwrite", is_flag=True, help="Replace the output if it exists.")
@_topic_options
def layout(
    log: Path | None,
    output: Path | None,
    robot: str | None,
    odom_topic: str | None,
    feet: tuple[str, ...],
    mass_kg: float | None,
    *,
    overwrite: bool,
) -> None:
    """Print a Foxglove layout for annotated logs: the robot, its loads and its gait diagram.

    The feet are those of the robot (default: dogbot), or those found in LOG.
    """
    from dogbot_logtool.layout import layout_for

    options = _parse_topics(robot, odom_topic, feet, mass_kg)
    text = json.dumps(layout_for(log, options), indent=2) + "\n"
    if output is None:
        click.echo(text, nl=False)
        return
    from dogbot_logtool.writer.output import refuse_bad_target, whole_file

    refuse_bad_target(output, log, overwrite=overwrite)
    with whole_file(output, overwrite=overwrite) as file:
        file.write(text.encode())


@cli.command()
@click.argument("name", required=False)
@_JSON
def robots(name: str | None, *, as_json: bool) -> None:
    """List the known robots, or print one's file to copy and edit."""
    from dogbot_logtool.robot import known_robots, load_robot, robot_toml

    if name is not None:
        click.echo(robot_toml(name), nl=False)
        return
    known = {robot: load_robot(robot).description for robot in known_robots()}
    if as_json:
        click.echo(json.dumps(known, indent=2))
        return
    for robot, description in known.items():
        click.echo(f"{robot:<12}{description}")


class _Outcomes:
    """Results and exit code of one call, over several logs: a bad log does not stop the rest."""

    def __init__(self) -> None:
        self._results: list[dict[str, Any]] = []
        self._codes: list[int] = []
        self._source: Path | None = None

    def of(self, source: Path) -> "_Outcomes":
        """Name the log at hand."""
        self._source = source
        return self

    def __enter__(self) -> None:
        return None

    def __exit__(self, _kind: object, error: BaseException | None, _trace: object) -> bool:
        if not isinstance(error, LogtoolError):
            return False
        _say_error(error)
        self._codes.append(error.exit_code)
        self._results.append({"input": str(self._source), "error": str(error)})
        return True

    def add(self, result: dict[str, Any], exit_code: int) -> None:
        """Take the result of a log."""
        self._results.append(result)
        self._codes.append(exit_code)

    def finish(self, *, as_json: bool, single: bool) -> NoReturn:
        """Print the results if wanted, and exit: failure counts more than damage."""
        if as_json:
            click.echo(json.dumps(self._results[0] if single else self._results, indent=2))
        sys.exit(next((code for code in (1, 2, 3) if code in self._codes), 0))


def _cores() -> int:
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _say_error(error: LogtoolError) -> None:
    from dogbot_logtool.report.console import printable

    text = "\n".join(printable(line) for line in str(error).split("\n"))
    click.echo(click.style("error: ", fg="red") + text, err=True)


def _stop(_signal: int, _frame: FrameType | None) -> NoReturn:
    raise KeyboardInterrupt


def main() -> NoReturn:
    """Run the command line; every failure ends as a sentence and an exit code."""
    signal.signal(signal.SIGTERM, _stop)
    try:
        cli.main(standalone_mode=False)
    except click.exceptions.Abort:
        click.echo("interrupted: nothing was left behind", err=True)
        sys.exit(130)
    except click.ClickException as error:
        error.show()
        sys.exit(error.exit_code)
    except LogtoolError as error:
        _say_error(error)
        sys.exit(error.exit_code)
    except BrokenPipeError:
        # Whoever read our output has seen enough.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        sys.exit(0)
    sys.exit(0)
