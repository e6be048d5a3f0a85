// Buttons, keys, mouse, and the cursor that the figures share.
function startReplay() {
  const canvas = document.getElementById("replay"), scrub = document.getElementById("scrub");
  const play = document.getElementById("play"), speed = document.getElementById("speed"), follow = document.getElementById("follow");
  const replay = new Replay(read("replay-data"), canvas);
  const first = replay.time[0], last = replay.time[replay.time.length - 1];
  let playing = false, before = 0;
  // The slider counts frames: silences take no room on it.
  const lastFrame = replay.time.length - 1;
  const frame = (time) => Math.max(lastUpTo(replay.time, time + 1e-4), 0);
  Object.assign(scrub, { max: lastFrame, value: 0 });
  const said = document.getElementById("happens"), ticks = document.getElementById("ticks");
  for (const event of replay.events) {
    const tick = document.createElement("i");
    tick.style.left = `${100 * frame(event.at) / (lastFrame || 1)}%`;
    tick.className = event.minor ? "minor" : "";
    ticks.append(tick);
  }
  function go(time, from) {
    replay.seek(time);
    scrub.value = replay.row;
    scrub.ariaValueText = `${replay.now.toFixed(3)} s`;
    const newest = replay.events.findLast((event) => event.at <= replay.now + 1e-3 && replay.now - event.at < 1.5);
    said.textContent = newest ? newest.what : "";
    if (from !== "cursor") cursor.set(replay.now, "replay");
  }
  function setPlaying(next) {
    playing = next;
    play.textContent = playing ? "❚❚ pause" : "▶ play";
    play.setAttribute("aria-pressed", playing);
    before = performance.now();
    if (playing && replay.now >= last - 1e-3) go(first);
    if (playing) requestAnimationFrame(tick);
  }
  function tick(now) {
    if (!playing) return;
    let time = replay.now + Math.min((now - before) / 1000, 0.25) * Number(speed.value);
    before = now;
    // The replay skips silences, and goes on where a long log is shown in full.
    const next = replay.time[Math.min(replay.row + 1, replay.time.length - 1)];
    if (next - replay.time[replay.row] > 0.5) time = Math.max(time, next);
    go(time);
    if (time >= last) setPlaying(false); else requestAnimationFrame(tick);
  }
  const step = (direction) => {
    const others = replay.events.map((event) => event.at).filter((at) => direction * (at - replay.now) > 1e-3);
    if (others.length) { setPlaying(false); go(direction > 0 ? Math.min(...others) : Math.max(...others)); }
  };
  play.addEventListener("click", () => setPlaying(!playing));
  scrub.addEventListener("input", () => { setPlaying(false); go(replay.time[Number(scrub.value)]); });
  for (const button of document.querySelectorAll("button[data-replay]")) {
    button.addEventListener("click", () => step(button.dataset.replay === "forth" ? 1 : -1));
  }
  follow.addEventListener("click", () => {
    replay.follows = !replay.follows;
    follow.setAttribute("aria-pressed", replay.follows);
    replay.draw();
  });
  canvas.addEventListener("keydown", (event) => {
    const keys = { " ": () => setPlaying(!playing), n: () => step(1), p: () => step(-1), ArrowRight: () => go(replay.now + 0.04), ArrowLeft: () => go(replay.now - 0.04) };
    const action = keys[event.key];
    if (action && !event.ctrlKey && !event.metaKey && !event.altKey) { event.preventDefault(); action(); }
  });
  let held = null;
  canvas.addEventListener("pointerdown", (event) => { held = [event.clientX, event.clientY]; canvas.setPointerCapture(event.pointerId); });
  canvas.addEventListener("pointerup", () => { held = null; });
  canvas.addEventListener("pointermove", (event) => {
    if (!held) return;
    const { camera } = replay, [dx, dy] = [event.clientX - held[0], event.clientY - held[1]];
    held = [event.clientX, event.clientY];
    if (event.shiftKey) {
      replay.follows = false;
      follow.setAttribute("aria-pressed", "false");
      const scale = camera.distance / camera.focus;
      camera.target = camera.target.map((value, axis) => value - (dx * camera.right[axis] - dy * camera.up[axis]) * scale);
    } else {
      camera.turn -= dx * 0.008;
      camera.tilt = Math.min(Math.max(camera.tilt + dy * 0.008, 0.02), 1.55);
    }
    replay.draw();
  });
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    replay.camera.distance *= Math.exp(Math.sign(event.deltaY) * 0.12);
    replay.draw();
  }, { passive: false });
  // The first picture shows the robot whole, also on paper.
  go(replay.time[replay.built], "cursor");
  cursor.listeners.push((time, from) => {
    if (from === "replay" || time === null || (playing && from === "hover")) return;
    if (from === "event" || from === "click") setPlaying(false);
    go(time, "cursor");
  });
  new ResizeObserver(() => replay.draw()).observe(canvas);
  onColours.push(() => replay.draw());
}
