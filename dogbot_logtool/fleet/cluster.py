"""An engine of dask.distributed: a cluster that is there already, or one on this machine."""

import logging
import re
import uuid
from typing import Any, Final

from dogbot_logtool import __version__
from dogbot_logtool.errors import CallError, ExtraMissingError, LogtoolError
from dogbot_logtool.fleet.engine import Crew, Failure, Result, Watch, Work, attempt

try:
    import dask.config
    import distributed
except ImportError as error:
    raise ExtraMissingError("--scheduler", "fleet") from error

_RECONNECTIONS: Final = 2
_PATIENCE_S: Final = 30
_LOOK_EVERY_S: Final = 5
_LOCAL: Final = re.compile(r"local:([1-9]\d{0,3})")
_ADDRESS: Final = re.compile(r"(tcp|tls|ws|wss|ucx)://\S+")


class Cluster(Crew[Result]):
    """The workers of a scheduler.

    What a lost worker had in hand is given to another one, thrice at most, and a scheduler that
    comes back is given all that was not done.
    """

    jobs = 1

    def __init__(self, scheduler: str) -> None:
        """Connect.

        Args:
            scheduler: ``tcp://host:port``, or ``local:N`` for N processes here.

        Raises:
            CallError: it is neither.
            LogtoolError: nobody answers.
        """
        local = _LOCAL.fullmatch(scheduler)
        if not local and not _ADDRESS.fullmatch(scheduler):
            raise CallError(
                f"--scheduler {scheduler}: must be an address such as tcp://host:8786, or local:N "
                "for N processes on this machine"
            )
        self._name = scheduler
        self._local = _local_cluster(int(local[1])) if local else None
        self._address = self._local.scheduler_address if self._local else scheduler
        self._run = uuid.uuid4().hex[:12]
        self._reconnections = 0
        self._submitted = 0
        self._asked_for_workers = False
        self._given_up = False
        self._handed_out: dict[int, tuple[Work[Any], object]] = {}
        self._numbers: dict[distributed.Future[Any], int] = {}
        self._watch: Watch | None = None
        self._connect()

    def _connect(self) -> None:
        try:
            self._client = distributed.Client(
                self._address, timeout=_PATIENCE_S, set_as_default=False
            )
        except (OSError, ValueError) as error:
            raise LogtoolError(f"--scheduler {self._name}: nobody answers there") from error
        self._comm = self._client.scheduler_comm
        self._done = distributed.as_completed([], loop=self._client.loop)
        self._client.subscribe_topic(self._run, self._hear)
        self._client.subscribe_topic("all", self._hear_of_workers)

    def _begin(self, number: int, work: Work[Result], item: object, watch: Watch) -> None:
        self._watch = watch
        self._handed_out[number] = work, item
        if self._given_up or self._client.status != "running":
            # Without a future, it makes `_wait` connect anew, or tell that it is not done.
            return
        if not self._asked_for_workers:
            self._asked_for_workers = True
            if not self._client.scheduler_info(n_workers=-1)["workers"]:
                watch.say(f"{self._name} has no workers yet; waiting for them")
        future = self._client.submit(
            _attempt,
            __version__,
            self._run,
            number,
            work,
            item,
            key=f"dogbot-logtool-{self._run}-{self._submitted:09}",
            pure=False,
        )
        self._submitted += 1
        self._numbers[future] = number
        self._done.add(future)

    def _wait(self, watch: Watch) -> list[tuple[int, Result | Failure]]:
        if self._given_up:
            return self._not_done()
        if len(self._handed_out) > len(self._numbers):
            return self._reconnect(watch)
        future = next(self._done)
        if future.status == "lost":
            # Its worker went before the result came; another one is at it.
            self._done.add(future)
            return []
        try:
            outcome = self._result(future)
        except (distributed.client.FutureCancelledError, OSError):
            # The scheduler went.
            return self._reconnect(watch)
        except Exception as error:  # noqa: BLE001 - whatever a cluster comes up with
            outcome = _failure(error)
        number = self._numbers.pop(future)
        del self._handed_out[number]
        return [(number, outcome)]

    def _result(self, future: Any) -> Any:  # noqa: ANN401 - dask's
        """Fetch a result, which is done again if its worker was lost in the meantime.

        Raises:
            ConnectionError: the scheduler was lost, so that nobody does it.
        """
        while True:
            try:
                return future.result(timeout=_LOOK_EVERY_S)
            except TimeoutError:
                if self._client.scheduler_comm is not self._comm:
                    raise ConnectionError from None

    def _reconnect(self, watch: Watch) -> list[tuple[int, Result | Failure]]:
        """Hand out anew what a lost scheduler had, or give up."""
        left, self._handed_out, self._numbers = self._handed_out, {}, {}
        self._reconnections += 1
        self._client.close()
        try:
            if self._reconnections > _RECONNECTIONS:
                raise LogtoolError(
                    f"the scheduler {self._name} was lost {self._reconnections} times"
                )
            self._connect()
        except LogtoolError:
            self._given_up = True
            self._handed_out = left
            return self._not_done()
        watch.say(f"the scheduler {self._name} was lost; what it had is handed out again")
        for number, (work, item) in left.items():
            self._begin(number, work, item, watch)
        return []

    def _give_up(self) -> None:
        left, self._handed_out, self._numbers = list(self._numbers), {}, {}
        if left and self._client.status == "running":
            self._client.cancel(left, force=True)
            self._done = distributed.as_completed([], loop=self._client.loop)

    def _not_done(self) -> list[tuple[int, Result | Failure]]:
        """Return what is left, not done."""
        left, self._handed_out = self._handed_out, {}
        what = f"was not done: the scheduler {self._name} was lost"
        return [(number, Failure(what, 1)) for number in left]

    def _hear(self, event: tuple[float, Any]) -> None:
        if self._watch is not None:
            self._watch.told(*event[1])

    def _hear_of_workers(self, event: tuple[float, Any]) -> None:
        news = event[1]
        gone = isinstance(news, dict) and news.get("action") == "remove-worker"
        if gone and not news.get("expected") and self._watch is not None:
            worker = news.get("worker", "")
            self._watch.say(f"worker {worker} was lost; others do what it had in hand")

    def close(self) -> None:
        """Leave the scheduler; end the processes of a cluster on this machine."""
        self._watch = None
        if self._client.status == "running":
            self._client.unsubscribe_topic(self._run)
            self._client.unsubscribe_topic("all")
        self._client.close()
        if self._local is not None:
            self._local.close()


def _local_cluster(workers: int) -> "distributed.LocalCluster":
    # What waits on a worker that dies is suspected, too: nothing shall wait there.
    with dask.config.set({"distributed.scheduler.worker-saturation": 1.0}):
        return distributed.LocalCluster(
            n_workers=workers,
            threads_per_worker=1,
            dashboard_address=None,
            host="127.0.0.1",
            silence_logs=logging.CRITICAL,
        )


def _failure(error: BaseException | None) -> Failure:
    if isinstance(error, distributed.KilledWorker):
        what = "every worker that worked on it died: perhaps for want of memory"
        return Failure(what, 1)
    if isinstance(error, ModuleNotFoundError):
        return Failure(f"the workers cannot run it: {error}; install dogbot-logtool there", 1)
    return Failure(f"the cluster failed: {type(error).__name__}: {error}", 1)


def _attempt(
    version: str, run: str, number: int, work: Work[Result], item: object
) -> Result | Failure:
    """Work on an item; runs on a worker."""
    if version != __version__:
        return Failure(f"the worker has dogbot-logtool {__version__}, not {version}", 1)
    worker = distributed.get_worker()

    def tell(done: int, total: int) -> None:
        worker.log_event(run, (number, done, total))

    return attempt(work, item, tell)
