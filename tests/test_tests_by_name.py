"""A module's test is found by its name, or in the table here.

What several modules do together is tried together: every type of message by one walk in each, the
command line as a user calls it, a whole recording through its container. The table says where.
"""

import re
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Final

from tests.test_imports import MODULES, PACKAGE, ROOT, imports_of, reached_from

TESTS: Final = Path(__file__).parent
TOGETHER: Final[Mapping[str, str]] = {
    # The root.
    "__main__": "cli/test_processes",
    "errors": "cli/test_cli",
    "finding": "core/checks/test_checks",
    "provenance": "pipeline/topics/test_annotated",
    "results": "commands/test_convert",
    "signals": "run/test_signals",
    # Whole logs as columns.
    "core/recording": "test_one_walk_anywhere",
    "core/walk": "test_one_walk_anywhere",
    "reader/decode/element_skipper": "reader/decode/test_malformed_messages",
    "reader/part": "test_one_walk_anywhere",
    "reader/recording": "test_one_walk_anywhere",
    "reader/wanted": "test_one_walk_anywhere",
    # The command line, as a user calls it.
    "api/export": "cli/test_export",
    "api/keywords": "api/test_parity",
    "cli/": "cli/test_cli",
    "cli/compare": "commands/test_compare_gait",
    "cli/dataset": "report/dataset/test_dataset",
    "cli/report": "cli/test_outputs",
    "cli/two_sides": "commands/test_compare_gait",
    "commands/check": "cli/test_check",
    "commands/plot": "report/files/test_gait_figure",
    "commands/tasks": "run/test_many_logs",
    # Whole logs, compared.
    "comparison/outcome": "comparison/test_compare_patterns",
    "comparison/stats_json": "commands/test_compare",
    "comparison/logs/": "comparison/test_compare_logs",
    "comparison/logs/decoders": "comparison/test_compare_encodings",
    # Whole walks in closed form, measured.
    "core/": "core/test_statistics",
    "core/effort_doubts": "truth/test_effort_signs",
    "core/records": "core/test_metrics",
    "core/walk_metrics/": "core/walk_metrics/test_walk",
    "core/leg_evaluation": "truth/test_joint_faults",
    "core/plausible": "cli/test_extreme_numbers",
    "core/base/": "core/base/test_base_motion",
    "core/base/tipping": "core/base/test_falls",
    "core/commands/held_command": "core/commands/test_tracking",
    "core/contact/": "core/contact/test_foot_history",
    "core/contact/offsets": "pipeline/test_sensors",
    "core/events/": "core/events/test_events",
    "core/events/messages": "core/events/test_log_messages",
    "core/checks/": "core/test_faulty_walks",
    "core/frames/recorded_transforms": "core/frames/test_frame_edges",
    "core/gait/": "core/test_statistics",
    "core/gait/gait_classes": "core/gait/test_gait",
    "core/gait/strides": "core/gait/test_segments",
    "core/geometry/blocks": "core/contact/test_contacts",
    "core/imu/": "core/imu/test_comparison",
    "core/legs/": "core/legs/test_leg_history",
    "core/legs/joint_cycles": "core/legs/test_effort_signs",
    "core/legs/joint_values": "truth/test_joint_faults",
    "core/legs/leg_figures": "truth/test_physics_legs",
    "core/load/loads": "core/scene/test_loads",
    "core/scene/foot_style": "commands/test_layout",
    "core/scene/legs": "commands/test_convert_legs",
    "core/quality/log_clock": "core/test_faulty_walks",
    "core/sensors/": "core/sensors/test_sensor_level",
    # The annotated log.
    "conversion/": "commands/test_convert",
    "conversion/provenance": "pipeline/topics/test_annotated",
    # Files, stores and words from a user.
    "io/local_file": "io/test_output",
    "io/printable": "cli/test_hostile_names",
    "io/scratch": "reader/containers/sources/test_remote_source",
    "io/storage": "reader/containers/sources/test_remote_source",
    "io/toml_table": "test_robot_errors",
    # A log before it is read through, and while it is.
    "pipeline/options": "api/test_parity",
    "pipeline/probe_findings": "commands/test_info",
    "pipeline/feet/candidates": "pipeline/feet/test_field_feet",
    "pipeline/feet/cells": "pipeline/feet/test_field_feet",
    "pipeline/feet/elements": "pipeline/feet/test_field_feet",
    "pipeline/feet/flag_check": "reader/messages/test_state_messages",
    "pipeline/feet/message_feet": "reader/messages/test_state_messages",
    "pipeline/feet/raw_levels": "reader/messages/test_sources",
    "pipeline/feet/readings": "pipeline/feet/test_names",
    "pipeline/feet/selection": "pipeline/feet/test_offers",
    "pipeline/feet/words": "pipeline/feet/test_names",
    "pipeline/frames/frame_findings": "pipeline/frames/test_frames",
    "pipeline/measuring/": "commands/test_stats",
    "pipeline/measuring/side_types": "pipeline/measuring/test_side_topics",
    "pipeline/robot_model/joint_motion": "commands/test_convert_joints",
    "pipeline/robot_model/limbs": "report/page/test_replay",
    "pipeline/robot_model/shape": "commands/test_layout",
    "pipeline/robot_model/skeleton": "pipeline/robot_model/test_primitives",
    "pipeline/topics/": "pipeline/topics/test_selection",
    "pipeline/topics/base_candidates": "pipeline/topics/test_base",
    # Recordings, sound and damaged, byte by byte; each container in one file.
    "reader/not_a_log": "reader/test_opening",
    "reader/containers/": "reader/test_mcap",
    "reader/containers/bag/": "reader/test_bag",
    "reader/containers/chunks/": "reader/test_contradictions",
    "reader/containers/chunks/packed_messages": "reader/test_sqlite",
    "reader/containers/mcap/": "reader/test_mcap",
    "reader/containers/rosbag2/": "reader/containers/rosbag2/test_directory",
    "reader/containers/sources/zstd_file": "reader/test_opening",
    "reader/containers/sqlite/": "reader/test_sqlite",
    "reader/salvage/bag_recovery_scan": "reader/test_bag",
    "reader/salvage/losses": "reader/test_mcap",
    "reader/salvage/mcap_recovery_scan": "reader/test_mcap",
    "reader/salvage/recovery_scan": "reader/test_mcap",
    # Messages: all types by one walk in each, and by damaged messages of each.
    "reader/decode/fields": "reader/decode/test_objects",
    "reader/decode/known_definitions": "reader/test_other_definitions",
    "reader/decode/message_table": "reader/test_registry",
    "reader/messages/": "reader/messages/test_types",
    "reader/messages/bases": "pipeline/topics/test_base",
    "reader/messages/frame_tracks": "pipeline/frames/test_frames",
    "reader/messages/messages": "reader/test_other_definitions",
    "reader/messages/transforms": "pipeline/frames/test_frames",
    "reader/messages/vectors": "pipeline/measuring/test_side_topics",
    # What people and scripts read: made of one walk in closed form, or drawn and looked at.
    "report/gait_comparison": "commands/test_compare_gait",
    "report/info_report": "commands/test_info",
    "report/numbers": "report/page/test_render",
    "report/verdict": "report/test_stats_report",
    "report/dataset/": "report/dataset/test_dataset",
    "report/documents/check_json": "cli/test_check",
    "report/documents/check_junit": "cli/test_check",
    "report/documents/comparison_json": "commands/test_compare",
    "report/documents/convert_json": "cli/test_convert",
    "report/documents/damage": "commands/test_info",
    "report/documents/junit": "commands/test_compare",
    "report/documents/stats_json": "report/test_stats_report",
    "report/documents/finding_json": "report/test_stats_report",
    "report/documents/metrics_schema": "core/test_metrics",
    "report/tables": "report/test_stats_report",
    "report/files/robot_file": "commands/test_new_robot",
    "report/files/stride_table": "report/test_stats_report",
    "report/files/table_file": "cli/test_export",
    "report/layouts/": "commands/test_layout",
    "report/layouts/viewers": "io/test_targets",
    "report/page/": "report/page/test_render",
    "report/page/libraries": "commands/test_report",
    "report/page/page_result": "cli/test_outputs",
    "report/page/charts/": "report/page/test_render",
    "report/page/charts/comparison_figures": "report/page/test_comparison",
    "report/text/": "cli/test_cli",
    "report/text/check_text": "cli/test_check",
    "report/text/comparison_text": "commands/test_compare",
    "report/text/dataset_text": "report/dataset/test_dataset",
    "report/text/frames_text": "pipeline/frames/test_frames",
    "report/text/legs_text": "report/page/test_render",
    "report/text/stats_summary": "report/test_stats_report",
    "report/text/stats_text": "report/test_stats_report",
    # Many logs at once, and one on several cores.
    "run/": "run/test_runner",
    "run/search": "run/test_inputs",
    # Messages that are written.
    "writer/encodings/": "writer/encodings/test_ros1",
    "writer/messages/": "writer/test_annotations",
    "writer/messages/shown": "writer/messages/test_labels",
}
"""Test file of a module, or, behind a slash, of all other modules of a folder without their own."""


def own_test(module: str) -> Path:
    """Where the test of a module is looked for first: ``core/gait/gait`` in `test_gait`."""
    folder, _, name = module.rpartition("/")
    return TESTS / folder / f"test_{name}.py"


def entry_of(module: str) -> str:
    """The entry of the table that is about a module: its own, or else its folder's."""
    return module if module in TOGETHER else f"{module.rpartition('/')[0]}/"


PATHS: Final = [file.relative_to(ROOT).with_suffix("").as_posix() for file in MODULES]
NAMED: Final = [path for path in PATHS if not path.endswith("__init__")]
OTHERS: Final = [module for module in NAMED if not own_test(module).exists()]


@cache
def imports() -> Mapping[str, set[str]]:
    """What each file of the package and of the tests imports, late imports included."""
    files = {_dotted(file): file for file in [*MODULES, *TESTS.rglob("*.py")]}
    found = {name: _imported(file) & files.keys() for name, file in files.items()}
    # Commands are loaded by their names.
    found["dogbot_logtool.cli"] |= {
        name for name in files if name.startswith("dogbot_logtool.cli.")
    }
    return found


def _dotted(file: Path) -> str:
    parts = file.relative_to(TESTS.parent).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def _imported(file: Path) -> set[str]:
    """The modules that a file imports, and those named in scripts that a test runs."""
    if file.is_relative_to(ROOT):
        return {*imports_of(file)}
    named = re.findall(rf"\b{PACKAGE}(?:\.\w+)+", file.read_text(encoding="utf-8"))
    return {*imports_of(file), *named}


@cache
def loaded_by(test: str) -> set[str]:
    """All modules that a test file imports, and those that these import."""
    return reached_from(imports(), f"tests.{test.replace('/', '.')}")


def test_a_module_has_a_test_of_its_name_or_an_entry_in_the_table() -> None:
    assert [module for module in OTHERS if entry_of(module) not in TOGETHER] == []


def test_the_table_names_files_that_load_the_modules() -> None:
    assert [
        f"{test} does not import {module}"
        for module in OTHERS
        if (test := TOGETHER.get(entry_of(module)))
        and f"{PACKAGE}.{module.replace('/', '.')}" not in loaded_by(test)
    ] == []


def test_the_table_has_no_entry_too_many() -> None:
    assert sorted(TOGETHER.keys() - {entry_of(module) for module in OTHERS}) == []
