"""The functions of `import dogbot_logtool`: one a command, options named as on the command line."""

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Literal, TypedDict, Unpack

from dogbot_logtool.io.storage import Location, location

# Each function loads what it needs: who only measures need not load the writer.
if TYPE_CHECKING:
    from dogbot_logtool.api.walk import Walk
    from dogbot_logtool.comparison.outcome import Comparison
    from dogbot_logtool.comparison.rules.judge import Judgement
    from dogbot_logtool.pipeline.options import (
        TfOption,
        TimeSourceOption,
        TopicOptions,
        WrenchFrameOption,
    )
    from dogbot_logtool.results import Conversion, LogInfo
    from dogbot_logtool.writer.chunks import Compression

PathOrName = str | os.PathLike[str]
"""A file, the directory of a ROS 2 bag, or a URL."""


class RobotKeywords(TypedDict, total=False):
    """Which robot it is, and where its feet and its base are found."""

    robot: PathOrName
    """Name of a known robot, or a TOML file; default: guessed from the log's topics."""
    odom_topic: str
    """Topic of the base's poses."""
    foot: Mapping[str, str]
    """Topic by foot, and the field where one is named: ``/feet:data[3]``."""
    mass: float
    """kg."""
    tare: Mapping[str, tuple[float, float, float]] | Literal["none"]
    """N, what a foot's unloaded sensor reads; ``"none"``: offsets stay in; default: estimated."""


class MeasureKeywords(RobotKeywords, total=False):
    """Options of `measure` and `check`."""

    wrench_frame: "WrenchFrameOption"
    forward_axis: Literal["+x", "-x", "+y", "-y"]
    contact_on: float
    """N, also `contact_off`."""
    contact_off: float
    debounce: float
    """s."""
    time_source: "TimeSourceOption"
    command: str
    """Topic of the velocity commands; default: found by type and name. Likewise `imu`."""
    imu: str
    start: float
    """s since the log's start, also `end`."""
    end: float
    jobs: int
    """Batches that are worked on at once; default: 1."""


class ConvertKeywords(RobotKeywords, total=False):
    """Options of `convert`."""

    style: Literal["classic", "pressure", "force"]
    encoding: Literal["foxglove", "ros1", "ros2"]
    copy: bool
    topics: Sequence[str]
    """Globs of the recorded topics that are copied."""
    without: Sequence[str]
    """Globs of the recorded topics that are not."""
    wrench_frame: "WrenchFrameOption"
    tf: "TfOption"
    tf_rate: float
    """Hz; 0 writes every pose."""
    scene: bool
    labels: bool
    urdf: PathOrName
    events: bool
    start: float
    """s since the log's start, also `end`."""
    end: float
    compression: "Compression"
    jobs: int
    overwrite: bool
    strict: bool


def measure(log: PathOrName, **options: Unpack[MeasureKeywords]) -> "Walk":
    """Measure a walk: what `dogbot-logtool stats` does.

    >>> import dogbot_logtool as dl
    >>> walk = dl.measure("sample_logs/dogbot_trot.bag")
    >>> walk.stats["gait"]["class"]
    'trot'
    >>> walk
    <Walk sample_logs/dogbot_trot.bag: trot, 24 strides>
    >>> round(float(walk.strides["duty_factor"][0]), 3)
    0.716

    Raises:
        CallError: no such file, or an option that does not fit the log.
        LogError: it is no log, or has nothing to measure.
    """
    from dogbot_logtool.api.walk import Walk  # noqa: PLC0415
    from dogbot_logtool.commands import stats  # noqa: PLC0415
    from dogbot_logtool.pipeline.options import StatsOptions  # noqa: PLC0415

    path = _location(log)
    chosen = StatsOptions(
        topics=_topics(options),
        wrench_frame=options.get("wrench_frame", "auto"),
        forward_axis=options.get("forward_axis"),
        contact_on_n=options.get("contact_on"),
        contact_off_n=options.get("contact_off"),
        debounce_s=options.get("debounce"),
        time_source=options.get("time_source"),
        command_topic=options.get("command"),
        imu_topic=options.get("imu"),
        start_s=options.get("start"),
        end_s=options.get("end"),
        jobs=options.get("jobs", 1),
    )
    return Walk(path, stats.measure(path, chosen), chosen)


def convert(
    log: PathOrName, target: PathOrName, **options: Unpack[ConvertKeywords]
) -> "Conversion":
    """Write the annotated MCAP of a log: what `dogbot-logtool convert` does.

    Raises:
        CallError: no such file, a target that may not be written, or an option that does not fit.
        LogError: the log cannot be read, has nothing to annotate, or is damaged and `strict`.
        LogtoolError: the target cannot be written.
    """
    from dogbot_logtool.commands import convert as command  # noqa: PLC0415
    from dogbot_logtool.core.scene.styles import DEFAULT_STYLE  # noqa: PLC0415
    from dogbot_logtool.pipeline.options import ConvertOptions  # noqa: PLC0415
    from dogbot_logtool.writer.encodings.registry import DEFAULT_ENCODING  # noqa: PLC0415

    urdf = options.get("urdf")
    chosen = ConvertOptions(
        topics=_topics(options),
        style=options.get("style", DEFAULT_STYLE),
        encoding=options.get("encoding", DEFAULT_ENCODING),
        copy=options.get("copy", True),
        copied_topics=tuple(options.get("topics", ())),
        topics_left_out=tuple(options.get("without", ())),
        wrench_frame=options.get("wrench_frame", "auto"),
        tf=options.get("tf", "auto"),
        tf_rate_hz=options.get("tf_rate", 50.0),
        start_s=options.get("start"),
        end_s=options.get("end"),
        scene=options.get("scene"),
        urdf=None if urdf is None else Path(urdf),
        labels=options.get("labels", True),
        events=options.get("events", False),
        compression=options.get("compression"),
        jobs=options.get("jobs", 1),
        overwrite=options.get("overwrite", False),
        strict=options.get("strict", False),
    )
    return command.convert(_location(log), _location(target), chosen)


def info(log: PathOrName, **options: Unpack[RobotKeywords]) -> "LogInfo":
    """Tell what is in a log, what is used for what, and what is wrong with it.

    Raises:
        CallError: no such file, or a topic that the log does not have.
        LogError: it is no log.
    """
    from dogbot_logtool.commands.info import describe  # noqa: PLC0415

    return describe(_location(log), _topics(options))


def compare(
    expected: PathOrName,
    actual: PathOrName,
    *,
    atol: float | None = None,
    rtol: float | None = None,
    tolerances: PathOrName | None = None,
    ignore: Sequence[str] = (),
    topics: Sequence[str] = (),
) -> "Comparison":
    """Compare two logs, or two results of `stats --json`; `exit_code` is 0 where they agree.

    Raises:
        CallError: an option is wrong, or a file is missing, unreadable, or not like the other.
    """
    from dogbot_logtool.commands import compare as command  # noqa: PLC0415
    from dogbot_logtool.pipeline.options import CompareOptions  # noqa: PLC0415

    chosen = CompareOptions(
        atol=atol,
        rtol=rtol,
        tolerances=None if tolerances is None else Path(tolerances),
        ignore=tuple(ignore),
        topics=tuple(topics),
    )
    return command.compare(Path(expected), Path(actual), chosen)


def check(
    log: PathOrName,
    limits: PathOrName,
    *,
    baseline: PathOrName | None = None,
    **options: Unpack[MeasureKeywords],
) -> "tuple[Judgement, ...]":
    """Judge a log by the rules of a file: what `dogbot-logtool check` does.

    Raises:
        CallError: a file is missing or not what it should be, or rules need a `baseline`.
        LogError: it is no log, or has nothing to measure.
    """
    from dogbot_logtool.commands import check as command  # noqa: PLC0415

    rules = command.read_limits(Path(limits), None if baseline is None else Path(baseline))
    return tuple(command.check(measure(log, **options).stats, rules))


def _location(path: PathOrName) -> Location:
    """Return the path or URL that was given."""
    return location(os.fspath(path))


def _topics(options: RobotKeywords) -> "TopicOptions":
    """Return the options about robot and topics."""
    from dogbot_logtool.pipeline.options import TopicOptions  # noqa: PLC0415

    robot, tare = options.get("robot"), options.get("tare")
    return TopicOptions(
        robot=None if robot is None else os.fspath(robot),
        odometry_topic=options.get("odom_topic"),
        foot_topics=dict(options.get("foot", {})),
        mass_kg=options.get("mass"),
        offsets_n=None if isinstance(tare, str) or tare is None else dict(tare),
        takes_offsets=tare != "none",
    )
