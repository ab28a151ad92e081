// What lies over the picture, in the plane and in space: trails, names, arrows, rings of blows, gauges.

const ARROWS = { contact: "#b3402a", joint: "#8a6d00", load: "#c96a00" };
const FLEX = "#1f7a5c", SPEED = "#1565c0";
const labelled = scene.frames.filter((f) => f.label).length + scene.bands.length;
const shows = { forces: true, joints: false, velocities: false, trails: true, names: labelled <= 15 };
const chosen = new Map(scene.bands.map((band) => [band, 0]));

// Lengths of arrows: the usual one is an eighth of the scene.
const reach = { velocity: usual(speeds()) };
for (const kind of Object.keys(ARROWS)) {
  reach[kind] = usual(scene.arrows.filter((a) => a.kind === kind).flatMap((a) => sizes(a.vector.numbers)));
}

function sizes(numbers) {
  const found = [];
  for (let k = 0; k + D <= numbers.length; k += D) found.push(Math.hypot(...numbers.subarray(k, k + D)));
  return found;
}

function speeds() {
  return scene.frames.filter((f) => f.velocity).flatMap((f) => sizes(f.velocity.numbers));
}

function vectorAt(packed, where, width, index) {
  return Array.from({ length: D }, (_, k) => at(packed, where, width, index + k));
}

function bandPoint(band, where, k) {
  return vectorAt(band.points, where, D * band.points.shape[1], D * k);
}

// Blue where negative, red where positive.
function colour(part) {
  const x = Math.max(-1, Math.min(1, part)), a = x < 0 ? [33, 84, 194] : [196, 38, 32], w = Math.abs(x) ** 0.7;
  const mixed = [205, 212, 220].map((v, k) => Math.round(v + w * (a[k] - v)));
  return `rgb(${mixed.join(",")})`;
}

function drawTrails(g, where) {
  const paths = scene.frames.filter((f) => f.velocity).map((f) => [f.motion, POSE, 0]);
  for (const band of scene.bands) paths.push([band.points, D * band.points.shape[1], D * (band.points.shape[1] - 1)]);
  for (const [packed, width, index] of paths.slice(0, 24)) {
    const rows = packed.shape[0];
    if (rows < 2) continue;
    const point = (k) => toScreen(packed.numbers.subarray(k * width + index, k * width + index + D));
    const stride = Math.ceil(rows / 400);
    g.beginPath();
    for (let k = 0; k < rows; k += stride) {
      const [x, y] = point(k);
      if (k) g.lineTo(x, y); else g.moveTo(x, y);
    }
    g.strokeStyle = "#9fb2c855";
    g.lineWidth = 1;
    g.stroke();
    // the newest part, in pieces that fade
    const from = place(Math.max(first, times[where.k] - 0.12 * (last - first))).k, pieces = 24;
    const now = toScreen(vectorAt(packed, where, width, index));
    const each = Math.max(1, Math.ceil((where.k - from) / pieces));
    for (let k = from; k <= where.k; k += each) {
      const end = Math.min(k + each, where.k), points = [];
      for (let i = k; i <= end; i += Math.max(1, Math.floor(each / 4))) points.push(point(i));
      points.push(end === where.k ? now : point(end));
      const part = (k - from + each) / (where.k - from + each);
      strokeLine(g, points, `rgba(31,95,191,${(0.75 * part).toFixed(3)})`, 1 + 1.2 * part);
    }
  }
}

function drawNames(g, where) {
  const taken = [];
  // a name that would cover another one is left out
  const free = (text, x, y, middle) => {
    const wide = 7 * text.length, left = middle ? x - 0.5 * wide : x;
    if (taken.some((box) => left < box[1] && left + wide > box[0] && Math.abs(y - box[2]) < 13)) return false;
    taken.push([left, left + wide, y]);
    return true;
  };
  scene.frames.forEach((frame, k) => {
    if (!frame.label) return;
    const [x, y] = toScreen(anchored({ frame: k, point: frame.label }, where));
    const middle = frame.label.every((v) => !v);
    const from = middle ? x : x + 4;
    if (free(frame.name, from, y, middle)) drawText(g, frame.name, from, y, INK, middle ? "center" : "left");
  });
  for (const band of scene.bands) {
    const [x, y] = toScreen(bandPoint(band, where, band.points.shape[1] >> 1));
    drawText(g, band.name, x, y - 16, FLEX, "center");
  }
}

function arrowTip(from, vector, usual) {
  const size = Math.hypot(...vector), length = Math.min(size / usual, 2.2) * 0.125 * scene.size;
  return size > 0 ? from.map((x, k) => x + (length * vector[k]) / size) : from;
}

function drawVelocities(g, where) {
  if (!reach.velocity) return;
  scene.frames.forEach((frame, k) => {
    if (!frame.velocity) return;
    const from = vectorAt(frame.motion, where, POSE, 0), v = vectorAt(frame.velocity, where, D, 0);
    const to = toScreen(arrowTip(from, v, reach.velocity));
    if (Math.hypot(...v) < 0.004 * reach.velocity) return;
    drawArrow(g, toScreen(from), to, SPEED);
    if (scene.frames.length < 9) drawText(g, shown(Math.hypot(...v), "m/s"), to[0] + 6, to[1] - 6, SPEED);
  });
}

// Contact forces end at the contact where they press, others begin where they act.
function drawForces(g, where, time) {
  for (const arrow of scene.arrows) {
    if (arrow.kind === "joint" ? !shows.joints : !shows.forces) continue;
    const from = vectorAt(arrow.at, where, D, 0), vector = vectorAt(arrow.vector, where, D, 0), size = Math.hypot(...vector);
    if (arrow.kind === "contact") drawBlows(g, arrow, time);
    if (!(size > 1e-3 * reach[arrow.kind])) continue;
    const to = toScreen(arrowTip(from, vector, reach[arrow.kind]));
    drawArrow(g, toScreen(from), to, ARROWS[arrow.kind]);
    if (scene.arrows.length < 13) drawText(g, shown(size, arrow.unit), to[0] + 7, to[1], ARROWS[arrow.kind]);
  }
}

// An impact of a constraint has no force but an impulse: a ring that fades for a third of a second of playing.
function drawBlows(g, arrow, time) {
  const fade = 0.35 * Math.max(state.speed, 1e-12);
  const near = (blows.get(arrow.name) || []).filter((event) => {
    const age = (time - event.t) / fade;
    return age >= -1e-9 && age <= 1;
  });
  for (const event of near) {
    const age = (time - event.t) / fade;
    const there = place(event.t);
    const [x, y] = toScreen(vectorAt(arrow.at, there, D, 0)), strength = 1 - Math.max(age, 0);
    g.beginPath();
    g.arc(x, y, 6 + 16 * (1 - strength), 0, 2 * Math.PI);
    g.strokeStyle = `rgba(179,64,42,${strength.toFixed(3)})`;
    g.lineWidth = 3 * strength + 0.5;
    g.stroke();
    // of blows that follow one another only the last one says its size, and what is left of bouncing does not
    if (event === near[near.length - 1] && event.impulse > 1e-3 * hardest) drawText(g, shown(event.impulse, event.impulse_unit), x + 12, y + 14, ARROWS.contact);
  }
}

// Coordinates without a place in the plane: pointers on scales of their own, in the middle if there is nothing else.
function drawGauges(g, where) {
  const count = Math.min(scene.gauges.length, Math.floor((camera.width - 20) / 110));
  if (!count) return;
  const alone = scene.frames.length < 2 && !scene.bands.length;
  const high = alone ? Math.max(80, camera.height - 230) : 90, top = alone ? 130 : camera.height - 150;
  const step = Math.min(130, (camera.width - 40) / count), left = alone ? 0.5 * (camera.width - step * count) : 10;
  scene.gauges.slice(0, count).forEach((gauge, k) => {
    const x = left + (k + 0.45) * step, n = gauge.values.numbers;
    let low = Infinity, up = -Infinity;
    for (const v of n) { if (v < low) low = v; if (v > up) up = v; }
    if (!(up - low > 1e-12 * Math.max(Math.abs(up), Math.abs(low)))) [low, up] = [low - 1, up + 1];
    const y = (v) => top + high * (1 - (v - low) / (up - low)), value = at(gauge.values, where, 1, 0);
    strokeLine(g, [[x, top], [x, top + high]], "#c5ccd6", 6);
    if (low < 0 && up > 0) strokeLine(g, [[x - 10, y(0)], [x + 10, y(0)]], "#6b7280", 1);
    strokeLine(g, [[x - 13, y(value)], [x + 13, y(value)]], FLEX, 5);
    drawText(g, gauge.name, x, top - 30, INK, "center");
    drawText(g, shown(value, gauge.unit), x, top - 14, FLEX, "center");
  });
}

function drawScale(g) {
  const length = round(130 / camera.scale), wide = length * camera.scale, y = camera.height - 16;
  strokeLine(g, [[12, y - 4], [12, y], [12 + wide, y], [12 + wide, y - 4]], "#6b7280", 1.4);
  drawText(g, shown(length, "m"), 18 + wide, y - 2, "#6b7280");
}
