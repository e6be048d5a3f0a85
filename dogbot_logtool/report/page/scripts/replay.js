// The walk in 3D, drawn on a plain canvas: a few hundred lines need neither WebGL nor a library.

// Eye, view and projection: z is up; the camera circles a point.
class Camera {
  constructor(distance) { Object.assign(this, { turn: -0.9, tilt: 0.42, distance, target: [0, 0, 0] }); }
  prepare(width, height) {
    const [ct, st, ch, sh] = [Math.cos(this.tilt), Math.sin(this.tilt), Math.cos(this.turn), Math.sin(this.turn)];
    this.right = [-sh, ch, 0];
    this.up = [-st * ch, -st * sh, ct];
    this.ahead = [-ct * ch, -ct * sh, -st];
    this.focus = 1.3 * Math.min(width, height * 1.6);
    [this.x, this.y] = [width / 2, height / 2];
  }
  // Pixels and depth of a point; null behind the eye.
  see(point) {
    const [x, y, z] = [point[0] - this.target[0], point[1] - this.target[1], point[2] - this.target[2]];
    const along = (axis) => axis[0] * x + axis[1] * y + axis[2] * z;
    const depth = along(this.ahead) + this.distance;
    if (!(depth > 0.05 * this.distance)) return null;
    const scale = this.focus / depth;
    return [this.x + along(this.right) * scale, this.y - along(this.up) * scale, depth, scale];
  }
}

// Columns of roll, pitch and yaw as a rotation: body to world.
function rotation(roll, pitch, yaw) {
  const [cr, sr, cp, sp, cy, sy] = [Math.cos(roll), Math.sin(roll), Math.cos(pitch), Math.sin(pitch), Math.cos(yaw), Math.sin(yaw)];
  return [[cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
    [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr], [-sp, cp * sr, cp * cr]];
}
const isKnown = (point) => point !== null && !Number.isNaN(point[0] + point[1] + point[2]);

// The corners of the convex hull of points, seen from above, in order.
function hull(points) {
  const sorted = [...points].sort((one, other) => one[0] - other[0] || one[1] - other[1]);
  const half = (source) => {
    const chain = [];
    for (const point of source) {
      while (chain.length > 1) {
        const [a, b] = chain.slice(-2);
        if ((b[0] - a[0]) * (point[1] - a[1]) - (b[1] - a[1]) * (point[0] - a[0]) > 0) break;
        chain.pop();
      }
      chain.push(point);
    }
    return chain.slice(0, -1);
  };
  return sorted.length < 3 ? sorted : [...half(sorted), ...half(sorted.reverse())];
}

class Replay {
  constructor(data, canvas) {
    Object.assign(this, unpackAll(data));
    this.canvas = canvas;
    this.pen = canvas.getContext("2d");
    this.camera = new Camera(4.2 * this.height + 0.6);
    this.row = 0;
    this.now = this.time[0];
    this.follows = true;
    this.drawn = 0;
    if (this.limbs) this.joints = this.limbs.parents.length;
    for (const foot of this.feet) {
      const isDown = (row) => foot.state[row] === 1 && foot.state[row - 1] !== 1 && isKnown(this.at(foot.point, row));
      foot.falls = Array.from(this.time, (_, row) => row).filter(isDown);
    }
    // The row that shows how the robot is built: the first at which base, joints and feet are known.
    this.built = Math.max(0, Array.from(this.time).findIndex((_, row) => this.isWhole(row)));
    this.body = this.bodySize();
    const yaw = this.at(this.angles, this.built)[2];
    this.camera.turn = (Number.isNaN(yaw) ? 0 : yaw) + this.forward + 0.75;
  }
  at(column, row, width = 3, first = 0) {
    const start = (row * width) + first;
    return [column[start], column[start + 1], column[start + 2]];
  }
  isWhole(row) {
    const joints = Array.from({ length: this.joints ?? 0 }, (_, joint) => this.joint(row, joint));
    return isKnown(this.at(this.position, row)) && joints.every(isKnown) && this.feet.every((foot) => isKnown(this.at(foot.point, row)));
  }
  // Half the length, width and height of the body, from where the legs hang.
  bodySize() {
    const corners = [];
    const spot = this.built;
    if (this.limbs) {
      for (let joint = 0; joint < this.joints; joint += 1) {
        if (this.limbs.parents[joint] === -1) corners.push(this.joint(spot, joint));
      }
    } else {
      const base = this.at(this.position, spot), turn = rotation(...this.at(this.angles, spot));
      for (const foot of this.feet) {
        const away = this.at(foot.point, spot).map((value, axis) => value - base[axis]);
        corners.push([0, 1].map((axis) => 0.8 * (turn[0][axis] * away[0] + turn[1][axis] * away[1] + turn[2][axis] * away[2])));
      }
    }
    const reach = (axis) => Math.max(...corners.map((each) => (each && Math.abs(each[axis])) || 0), 0.18 * this.height);
    return [reach(0), reach(1), 0.14 * this.height];
  }
  joint(row, joint) {
    const { point } = this.limbs, start = (row * this.joints + joint) * 3;
    return Number.isNaN(point[start]) ? null : [point[start], point[start + 1], point[start + 2]];
  }
  // Show a time: the frame that is nearest before it.
  seek(time) {
    this.now = Math.min(Math.max(time, this.time[0]), this.time[this.time.length - 1]);
    this.row = Math.max(lastUpTo(this.time, this.now + 1e-4), 0);
    this.draw();
  }
  resize() {
    const box = this.canvas.getBoundingClientRect(), dots = Math.min(devicePixelRatio || 1, 1.5);
    const [width, height] = [Math.round(box.width * dots), Math.round(box.height * dots)];
    if (this.canvas.width !== width || this.canvas.height !== height) Object.assign(this.canvas, { width, height });
    this.pen.setTransform(dots, 0, 0, dots, 0, 0);
    return [box.width, box.height];
  }
  draw() {
    const [width, height] = this.resize();
    if (!width || !height) return;
    const { pen, camera, row } = this;
    this.ink = { ink: colour("--ink"), soft: colour("--soft"), grid: colour("--grid"), panel: colour("--panel"), paper: colour("--paper"), link: colour("--link") };
    pen.clearRect(0, 0, width, height);
    const base = this.at(this.position, row);
    if (isKnown(base) && (this.follows || !this.placed)) {
      camera.target = [base[0], base[1], this.ground + 0.55 * Math.max(this.height, base[2] - this.ground)];
      this.placed = true;
    }
    camera.prepare(width, height);
    this.drawGround();
    this.drawPath();
    this.drawFootfalls();
    const feet = this.feet.map((foot) => ({ ...foot, place: this.at(foot.point, row), is: foot.state[row], force: foot.load[row] }));
    this.drawSupport(feet);
    const parts = [];
    if (isKnown(base)) this.addRobot(parts, base, rotation(...this.at(this.angles, row)), feet);
    for (const foot of feet) this.addFoot(parts, foot);
    parts.sort((one, other) => other.depth - one.depth);
    for (const part of parts) part.paint();
    for (const foot of feet) this.drawArrow(foot);
    pen.fillStyle = this.ink.ink;
    pen.font = "13px system-ui, sans-serif";
    pen.textAlign = "left";
    pen.fillText(`${this.now.toFixed(2)} s${isKnown(base) ? "" : ": where the base is, is not known"}`, 12, 22);
    this.drawn += 1;
    this.canvas.dataset.drawn = this.drawn;
  }
  line(points, shade, width, dash = []) {
    const { pen } = this;
    pen.beginPath();
    let down = false;
    for (const point of points) {
      const seen = isKnown(point) ? this.camera.see(point) : null;
      if (seen) { if (down) pen.lineTo(seen[0], seen[1]); else pen.moveTo(seen[0], seen[1]); }
      down = seen !== null;
    }
    Object.assign(pen, { strokeStyle: shade, lineWidth: width, lineCap: "round", lineJoin: "round" });
    pen.setLineDash(dash);
    pen.stroke();
  }
  drawGround() {
    const power = 10 ** Math.floor(Math.log10(this.height));
    const size = power * (this.height / power >= 5 ? 5 : this.height / power >= 2 ? 2 : 1);
    const [x, y] = this.camera.target.map((value) => Math.round(value / size));
    const z = this.ground, across = Array.from({ length: 21 }, (_, cell) => cell - 10);
    for (const each of across) {
      this.line(across.map((cell) => [(x + each) * size, (y + cell) * size, z]), this.ink.grid, 1);
      this.line(across.map((cell) => [(x + cell) * size, (y + each) * size, z]), this.ink.grid, 1);
    }
  }
  drawPath() {
    const step = Math.max(1, Math.floor(this.time.length / 600)), path = [];
    for (let row = 0; row < this.time.length; row += step) {
      const place = this.at(this.position, row);
      path.push([place[0], place[1], isKnown(place) ? this.ground : NaN]);
    }
    this.line(path, this.ink.soft, 1);
  }
  drawFootfalls() {
    const { pen } = this;
    for (const foot of this.feet) {
      const newest = lastUpTo(foot.falls, this.row);
      for (let fall = Math.max(0, newest - 40); fall <= newest; fall += 1) {
        const seen = this.camera.see(this.at(foot.point, foot.falls[fall]));
        if (!seen) continue;
        pen.beginPath();
        pen.ellipse(seen[0], seen[1], 4, 2.6, 0, 0, 7);
        pen.globalAlpha = fall > newest - 4 ? 1 : 0.55;
        Object.assign(pen, { strokeStyle: foot.colour, fillStyle: foot.colour, lineWidth: 1.5 });
        pen.setLineDash([]);
        if (foot.hind) pen.stroke(); else pen.fill();
        pen.globalAlpha = 1;
      }
    }
  }
  // The polygon of the feet that are down; none while one of them is not known.
  drawSupport(feet) {
    const { pen } = this;
    if (this.schematic || feet.some((foot) => foot.is === 2)) return;
    const down = feet.filter((foot) => foot.is === 1);
    if (!down.length || down.some((foot) => !isKnown(foot.place))) return;
    const corners = hull(down.map((foot) => foot.place));
    if (corners.length > 1) this.line([...corners, corners[0]], this.ink.link, 1.5);
    const seen = corners.map((corner) => this.camera.see(corner));
    if (corners.length > 2 && seen.every(Boolean)) {
      pen.beginPath();
      seen.forEach(([x, y], corner) => (corner ? pen.lineTo(x, y) : pen.moveTo(x, y)));
      Object.assign(pen, { fillStyle: this.ink.link, globalAlpha: 0.16 });
      pen.fill();
      pen.globalAlpha = 1;
    }
    const total = down.reduce((sum, foot) => sum + foot.force, 0);
    if (!(total > 0)) return;
    const centre = [0, 1, 2].map((axis) => down.reduce((sum, foot) => sum + foot.force * foot.place[axis], 0) / total);
    const spot = this.camera.see(centre);
    if (spot) this.disc(spot, 4.5, "#8e6bbf", this.ink.paper);
  }
  disc([x, y], radius, shade, edge, hollow = false) {
    const { pen } = this;
    pen.beginPath();
    pen.arc(x, y, radius, 0, 7);
    pen.setLineDash([]);
    Object.assign(pen, { fillStyle: hollow ? this.ink.paper : shade, strokeStyle: hollow ? shade : edge, lineWidth: 1.5 });
    pen.fill();
    pen.stroke();
  }
  // A straight part of the robot, to be painted in the order of depth.
  add(parts, from, to, shade, width, dash) {
    if (!isKnown(from) || !isKnown(to)) return;
    const [one, other] = [this.camera.see(from), this.camera.see(to)];
    if (!one || !other) return;
    const pixels = Math.max(width * (one[3] + other[3]) / 2, 1);
    parts.push({ depth: (one[2] + other[2]) / 2, paint: () => this.line([from, to], shade, pixels, dash) });
  }
  addRobot(parts, base, turn, feet) {
    const world = (point) => point && [0, 1, 2].map((axis) => base[axis] + turn[axis][0] * point[0] + turn[axis][1] * point[1] + turn[axis][2] * point[2]);
    const bone = 0.038 * this.height;
    if (this.limbs) {
      const joints = Array.from({ length: this.joints }, (_, joint) => world(this.joint(this.row, joint)));
      joints.forEach((joint, number) => {
        const parent = this.limbs.parents[number];
        if (parent >= 0) this.add(parts, joints[parent], joint, this.ink.soft, bone);
      });
    } else {
      for (const foot of feet) {
        if (!isKnown(foot.place)) continue;
        const away = foot.place.map((value, axis) => value - base[axis]);
        const inBody = [0, 1, 2].map((axis) => turn[0][axis] * away[0] + turn[1][axis] * away[1] + turn[2][axis] * away[2]);
        const hip = world([0, 1, 2].map((axis) => Math.max(-this.body[axis], Math.min(this.body[axis], inBody[axis]))));
        this.add(parts, hip, foot.place, this.ink.soft, bone, foot.is === 1 ? [] : [5, 6]);
      }
    }
    this.addBody(parts, world);
    const nose = [Math.cos(this.forward), Math.sin(this.forward), 0];
    const reach = Math.abs(nose[0]) > 0.5 ? this.body[0] : this.body[1];
    this.add(parts, world(nose.map((value) => value * reach)), world(nose.map((value) => value * (reach + 0.18 * this.height))), this.ink.ink, 0.5 * bone);
  }
  addBody(parts, world) {
    const [x, y, z] = this.body, { pen } = this;
    const corner = [[-x, -y, -z], [x, -y, -z], [x, y, -z], [-x, y, -z], [-x, -y, z], [x, -y, z], [x, y, z], [-x, y, z]].map(world);
    for (const side of [[0, 1, 2, 3], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]) {
      const seen = side.map((number) => this.camera.see(corner[number]));
      if (!seen.every(Boolean)) continue;
      parts.push({
        depth: seen.reduce((sum, each) => sum + each[2], 0) / 4,
        paint: () => {
          pen.beginPath();
          seen.forEach(([px, py], number) => (number ? pen.lineTo(px, py) : pen.moveTo(px, py)));
          pen.closePath();
          pen.setLineDash([]);
          Object.assign(pen, { fillStyle: this.ink.panel, strokeStyle: this.ink.soft, lineWidth: 1, globalAlpha: 0.85 });
          pen.fill();
          pen.globalAlpha = 1;
          pen.stroke();
        },
      });
    }
  }
  addFoot(parts, foot) {
    const seen = isKnown(foot.place) ? this.camera.see(foot.place) : null;
    if (!seen) return;
    parts.push({ depth: seen[2], paint: () => this.disc(seen, Math.max(3.5, 0.035 * this.height * seen[3]), foot.is === 2 ? this.ink.soft : foot.colour, this.ink.paper, foot.is !== 1) });
  }
  // The load of a foot, over the robot so that it is always seen.
  drawArrow(foot) {
    const seen = isKnown(foot.place) ? this.camera.see(foot.place) : null;
    if (seen && foot.is === 2) this.say(`${foot.short} ?`, seen);
    if (!seen || !(foot.is === 1 && foot.force > 0)) return;
    const length = Math.min(foot.force / this.newtons_per_metre, 2);
    const top = [foot.place[0], foot.place[1], foot.place[2] + length];
    const end = this.camera.see(top);
    if (!end) return;
    this.paintArrow(seen, end, foot, Math.max(2, 0.03 * this.height * seen[3]));
  }
  paintArrow(from, to, foot, width) {
    const { pen } = this;
    const [dx, dy] = [to[0] - from[0], to[1] - from[1]], long = Math.hypot(dx, dy);
    if (long > 2) {
      const size = Math.min(0.35 * long, 3.2 * width + 4), [ux, uy] = [dx / long, dy / long];
      pen.setLineDash([]);
      Object.assign(pen, { strokeStyle: foot.colour, lineWidth: width, lineCap: "round" });
      pen.beginPath();
      pen.moveTo(from[0], from[1]);
      pen.lineTo(to[0] - size * ux, to[1] - size * uy);
      pen.stroke();
      pen.beginPath();
      pen.moveTo(to[0], to[1]);
      pen.lineTo(to[0] - size * (ux + 0.45 * uy), to[1] - size * (uy - 0.45 * ux));
      pen.lineTo(to[0] - size * (ux - 0.45 * uy), to[1] - size * (uy + 0.45 * ux));
      pen.closePath();
      pen.fillStyle = foot.colour;
      pen.fill();
    }
    this.say(`${foot.short} ${foot.force.toFixed(0)} N`, to);
  }
  say(text, [x, y]) {
    const { pen } = this;
    Object.assign(pen, { fillStyle: this.ink.ink, strokeStyle: this.ink.paper, lineWidth: 3, font: "12px system-ui, sans-serif", textAlign: "center" });
    pen.setLineDash([]);
    pen.strokeText(text, x, y - 7);
    pen.fillText(text, x, y - 7);
  }
}
