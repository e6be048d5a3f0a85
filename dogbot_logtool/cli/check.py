"""The words of `check`."""

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from dogbot_logtool.cli.options import (
    jobs_option,
    jobs_or_cores,
    json_option,
    junit_option,
    junit_overwrite_option,
    logs_argument,
    quietness,
    scheduler_option,
    stats_options,
)
from dogbot_logtool.cli.outcomes import Outcomes
from dogbot_logtool.errors import CallError

if TYPE_CHECKING:
    from dogbot_logtool.comparison.rules.judge import Judgement
    from dogbot_logtool.robot.options import StatsOptions


@click.command()
@logs_argument
@click.option(
    "--limits",
    type=click.Path(path_type=Path),
    metavar="FILE.toml",
    help="Rules on figures, findings and events.",
)
@click.option(
    "--baseline",
    type=click.Path(path_type=Path),
    metavar="FILE.json",
    help="`stats --json` of the run that rules with `baseline` compare with.",
)
@click.option(
    "--suggest", is_flag=True, help="Print limits that these runs pass, as a file to edit."
)
@junit_option
@junit_overwrite_option
@stats_options
@jobs_option
@scheduler_option
@json_option
@quietness
def check(
    words: tuple[str, ...],
    limits: Path | None,
    baseline: Path | None,
    junit: Path | None,
    measuring: "StatsOptions",
    jobs: int | None,
    scheduler: str | None,
    *,
    suggest: bool,
    overwrite: bool,
    as_json: bool,
    quiet: bool,
    verbose: bool,
) -> None:
    """Judge logs by rules: each is GOOD, WARN, FAIL or UNKNOWN.

    A rule names a figure of `stats --json`, a finding or an event, by a pattern, and what is
    demanded of it; `check --suggest LOG...` prints a file of rules to begin with.

    Exit code 0: all rules are kept; 1: one is broken, or a figure is unknown where its rule does
    not allow that; 2: the call or the limits are wrong; 3: kept, but a log is damaged.
    """
    from dogbot_logtool.commands.check import check as judged  # noqa: PLC0415
    from dogbot_logtool.commands.check import exit_code, read_limits  # noqa: PLC0415
    from dogbot_logtool.commands.tasks import Measure  # noqa: PLC0415
    from dogbot_logtool.io.targets import refuse_bad_report  # noqa: PLC0415
    from dogbot_logtool.report.check_report import (  # noqa: PLC0415
        check_json,
        print_check,
    )
    from dogbot_logtool.report.documents import damage_json  # noqa: PLC0415
    from dogbot_logtool.report.text.console import results  # noqa: PLC0415
    from dogbot_logtool.run.choice import runner_for  # noqa: PLC0415
    from dogbot_logtool.run.inputs import find_logs  # noqa: PLC0415

    if (limits is None) != suggest:
        raise CallError("check needs one of --limits FILE.toml and --suggest")
    held = None if limits is None else read_limits(limits, baseline)
    if suggest and (baseline or junit or as_json):
        raise CallError("--suggest prints a limits file; it goes with none of the other outputs")
    log_set = find_logs(words, for_workers=scheduler is not None)
    if junit is not None:
        refuse_bad_report(junit, log_set.paths, overwrite=overwrite)
    runner = runner_for("stats", len(log_set.paths), jobs_or_cores(jobs), scheduler)
    work = Measure(replace(measuring, jobs=runner.jobs))
    outcomes = Outcomes(quiet=quiet)
    outcomes.mention_left_out(log_set)
    checked: dict[str, list[Judgement]] = {}
    documents: dict[str, dict[str, Any]] = {}
    for done in outcomes.of(runner, work, log_set.paths, log_set.names):
        name = done.json["log"]["path"]
        documents[name] = done.json
        if held is None:
            outcomes.add(done.json)
            continue
        checked[name] = judged(done.json, held)
        document = {**check_json(name, checked[name]), "damage": damage_json(done.damage)}
        outcomes.add(document, exit_code(checked[name]))
        if not as_json:
            print_check(results(), name, checked[name], verbose=verbose)
    if suggest and documents:
        _print_suggestion(documents)
    if junit is not None:
        _write_junit(junit, checked, dict(outcomes.failures), overwrite=overwrite)
    outcomes.finish(as_json=as_json)


def _print_suggestion(documents: dict[str, dict[str, Any]]) -> None:
    from dogbot_logtool.comparison.rules.suggestion import doubts, suggest_limits  # noqa: PLC0415
    from dogbot_logtool.io.printable import printable  # noqa: PLC0415

    names = [printable(name) for name in documents]
    runs = list(documents.values())
    click.echo(suggest_limits(runs, names), nl=False)
    for doubt in doubts(runs, names):
        click.echo(f"warning: {doubt}", err=True)


def _write_junit(
    target: Path,
    checked: "dict[str, list[Judgement]]",
    failures: dict[str, str],
    *,
    overwrite: bool,
) -> None:
    from dogbot_logtool.io.output import whole_file  # noqa: PLC0415
    from dogbot_logtool.report.check_report import check_junit  # noqa: PLC0415

    with whole_file(target, overwrite=overwrite) as file:
        file.write(check_junit(checked, failures))
