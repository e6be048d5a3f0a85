"""Logs whose topics are named as a test wants, of one synthetic walk."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from tests.oracles import base_walks, walks

WRENCH, CONTACTS = "geometry_msgs/msg/WrenchStamped", "gazebo_msgs/msg/ContactsState"
MODELS = "gazebo_msgs/msg/ModelStates"
LATE = 40
"""Samples by which every other foot is later."""


def write_log(
    path: Path,
    topics: Mapping[str, str],
    *,
    odometry: Sequence[str] = (),
    models: Mapping[str, float] | None = None,
    samples: int = 3,
) -> Path:
    """Write an MCAP with topics of contact messages, by type; feet take turns.

    Args:
        path: the file.
        topics: type by topic.
        odometry: topics of odometry.
        models: speed of each model of `/gazebo/model_states`, m a sample; None: no such topic.
        samples: how many.
    """
    walk = base_walks.ros()
    entries = []
    for sample in range(samples):
        time = walks.START + sample * walks.STEP
        data = walk.odometry(sample)
        entries += [walks.Entry(one, "nav_msgs/msg/Odometry", time, data) for one in odometry]
        if models is not None:
            listed = base_walks.models(walk, {name: v * sample for name, v in models.items()})
            entries.append(walks.Entry("/gazebo/model_states", MODELS, time, listed))
        for number, (topic, kind) in enumerate(topics.items()):
            down = (sample - number % 2 * LATE) % walks.PERIOD < walks.STANCE
            force = (0.0, 0.0, 60.0 if down else 0.0)
            header = walk.header(sample, "world")
            if kind == WRENCH:
                message = walk.make(kind, header=header, wrench=[force])
            else:
                states = [walk.classic_state("foot", force)] if down else []
                message = walk.make(kind, header=header, states=states)
            entries.append(walks.Entry(topic, kind, time, walk.bytes_of(kind, message)))
    walks.write_mcap(path, walk, entries)
    return path
