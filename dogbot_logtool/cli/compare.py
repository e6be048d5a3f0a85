"""`compare` on the command line."""

from pathlib import Path
from typing import NoReturn

import click

from dogbot_logtool.cli.call import Call, refuse_given, write
from dogbot_logtool.io.plain_json import to_json
from dogbot_logtool.option import options_of, part_of
from dogbot_logtool.options import MeasureOptions, RobotOptions
from dogbot_logtool.options.compare import Compare, CompareOptions
from dogbot_logtool.report.comparison_report import (
    comparison_json,
    comparison_junit,
    gait_comparison_json,
    print_gait_comparison,
    show_comparison,
)
from dogbot_logtool.report.text.console import results


def run(options: Compare) -> NoReturn:
    """Compare two files field by field, or how two sides walk."""
    if options.gait:
        others = [each.name for each in options_of(CompareOptions)]
        refuse_given(options, [*others, "junit"], "has no meaning with --gait")
    else:
        others = [each.name for each in options_of(RobotOptions)]
        refuse_given(options, others, "says how logs are measured: it goes with --gait")
    call = Call(options)
    if options.gait:
        _compare_gait(call, options)
    _compare_files(call, options)


def _compare_files(call: Call, options: Compare) -> NoReturn:
    """Compare two logs, or two `stats --json` files; exit."""
    from dogbot_logtool.commands.compare import compare  # noqa: PLC0415
    from dogbot_logtool.io.output import output_file  # noqa: PLC0415
    from dogbot_logtool.io.printable import printable  # noqa: PLC0415

    expected, actual = Path(options.expected), Path(options.actual)
    junit = output_file(options.junit, (expected, actual), overwrite=options.overwrite)
    comparison = compare(expected, actual, options)
    for damage in comparison.damage:
        call.add_damage(damage)
    if junit is not None:
        write(comparison_junit(comparison), junit, overwrite=options.overwrite)
    for warning in comparison.warnings:
        click.echo(printable(f"warning: {warning}"), err=True)
    if options.json:
        click.echo(comparison_json(comparison), nl=False)
    elif not options.quiet:
        show_comparison(comparison, results())
    call.finish(exit_code=comparison.exit_code)


def _compare_gait(call: Call, options: Compare) -> NoReturn:
    """Compare how the robot walks on either side; exit."""
    from dogbot_logtool.comparison.walks import compare_walks  # noqa: PLC0415

    sides = [call.logs((word,)) for word in (options.expected, options.actual)]
    first, second = call.sides(sides, part_of(options, MeasureOptions))
    found = compare_walks(first, second)
    if options.json:
        click.echo(to_json(gait_comparison_json(found), indent=2))
    elif not options.quiet:
        print_gait_comparison(results(), found, verbose=options.verbose)
    call.finish(exit_code=found.exit_code)
