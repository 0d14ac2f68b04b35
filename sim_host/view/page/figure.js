// The stick figure over the ground, from the signals of one tick.
const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
const SIDES = ["left", "right"];

export class Figure {
  constructor(canvas) {
    this.canvas = canvas;
    this.pushes = []; // {tick, x, side, energy}
    this.strikes = [];
    this.pose = null;
  }

  clear() { this.pushes = []; this.strikes = []; }

  event(event, store) {
    const x = store.value("hip_x", event.tick);
    if (event.kind === "push") this.pushes.push({ ...event, x: Number.isFinite(x) ? x : this.pose?.hip[0] ?? 0 });
    if (event.kind === "strike") this.strikes.push(event);
    if (this.pushes.length > 200) this.pushes.shift();
  }

  poseAt(store, tick, length) {
    const v = (name) => store.value(name, tick);
    const stance = v("stance") === 1 ? 1 : 0;
    const angles = [v("leg_angle_left"), v("leg_angle_right")];
    if (!Number.isFinite(angles[0]) || !Number.isFinite(angles[1])) return null;
    const hip = [v("hip_x") || 0, length * Math.cos(angles[stance])];
    const feet = angles.map((angle, i) => {
      const reach = length + Math.max(0, v(`ankle_${SIDES[i]}`) || 0);
      return [hip[0] + reach * Math.sin(angle), hip[1] - reach * Math.cos(angle)];
    });
    const heels = angles.map((angle) => [hip[0] + length * Math.sin(angle), hip[1] - length * Math.cos(angle)]);
    return { hip, feet, heels, stance, force: SIDES.map((s) => v(`spring_force_${s}`)), closed: SIDES.map((s) => v(`latch_closed_${s}`)) };
  }

  draw(store, tick, length) {
    const pose = this.pose = this.poseAt(store, tick, length) || this.pose;
    const { canvas } = this, scale = window.devicePixelRatio || 1;
    const width = canvas.clientWidth, height = canvas.clientHeight;
    if (canvas.width !== Math.round(width * scale)) canvas.width = Math.round(width * scale);
    if (canvas.height !== Math.round(height * scale)) canvas.height = Math.round(height * scale);
    const g = canvas.getContext("2d");
    g.setTransform(scale, 0, 0, scale, 0, 0);
    g.clearRect(0, 0, width, height);
    if (!pose) return;
    const metre = (height - 46) / (1.15 * length), ground = height - 26;
    const at = ([x, y]) => [width / 2 + (x - pose.hip[0]) * metre, ground - y * metre];
    this.drawGround(g, pose, metre, ground, width, length);
    for (const [i, push] of this.pushes.entries()) this.drawPush(g, push, i === this.pushes.length - 1, at, tick);
    for (const side of [1 - pose.stance, pose.stance]) this.drawLeg(g, pose, side, at);
    const [hx, hy] = at(pose.hip);
    g.fillStyle = css("--text");
    g.beginPath();
    g.arc(hx, hy, 9, 0, 7);
    g.fill();
  }

  drawGround(g, pose, metre, ground, width, length) {
    g.strokeStyle = g.fillStyle = css("--dim");
    g.lineWidth = 1;
    g.beginPath();
    g.moveTo(0, ground + 1);
    g.lineTo(width, ground + 1);
    const mark = length / 4, from = Math.ceil((pose.hip[0] - width / 2 / metre) / mark);
    g.font = "11px system-ui";
    for (let i = from; i * mark < pose.hip[0] + width / 2 / metre; i++) {
      const x = width / 2 + (i * mark - pose.hip[0]) * metre;
      g.moveTo(x, ground + 1);
      g.lineTo(x, ground + (i % 4 ? 5 : 10));
      if (i % 4 === 0) g.fillText(`${(i * mark).toFixed(1)} m`, x + 3, ground + 20);
    }
    g.stroke();
  }

  drawLeg(g, pose, side, at) {
    const name = SIDES[side], [hx, hy] = at(pose.hip), [kx, ky] = at(pose.heels[side]), [fx, fy] = at(pose.feet[side]);
    g.strokeStyle = css(`--${name}`);
    g.lineCap = "round";
    g.lineWidth = side === pose.stance ? 6 : 4;
    g.beginPath();
    g.moveTo(hx, hy);
    g.lineTo(kx, ky);
    g.stroke();
    g.lineWidth = 3;
    g.setLineDash([3, 3]);
    g.beginPath();
    g.moveTo(kx, ky);
    g.lineTo(fx, fy);
    g.stroke();
    g.setLineDash([]);
    g.fillStyle = pose.closed[side] === 1 ? css(`--${name}`) : css("--panel");
    g.lineWidth = 2;
    g.beginPath();
    g.arc(fx, fy, 5, 0, 7);
    g.fill();
    g.stroke();
  }

  drawPush(g, push, isLast, at, tick) {
    if (push.tick > tick) return;
    const [x, y] = at([push.x, 0]);
    g.fillStyle = css(`--${SIDES[push.side]}`);
    g.globalAlpha = Math.max(0.15, 1 - (tick - push.tick) / 6000);
    g.beginPath();
    g.moveTo(x - 5, y + 1);
    g.lineTo(x + 5, y + 1);
    g.lineTo(x, y - 9);
    g.fill();
    if (tick - push.tick < 800) {
      g.font = "bold 12px system-ui";
      g.fillText(`push ${push.energy_J.toPrecision(3)} J`, x - 30, y - 14);
    }
    g.globalAlpha = 1;
  }
}
