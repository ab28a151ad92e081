// The scene as it stands in the page: arrays are base64 text of little-endian numbers.

function array(packed) {
  const text = atob(packed.data);
  const bytes = new Uint8Array(text.length);
  for (let k = 0; k < text.length; k++) bytes[k] = text.charCodeAt(k);
  const numbers = packed.kind === "f8" ? new Float64Array(bytes.buffer) : new Float32Array(bytes.buffer);
  return { numbers, shape: packed.shape };
}

// Every packed array in the scene becomes {numbers, shape}.
function unpacked(value) {
  if (Array.isArray(value)) return value.map(unpacked);
  if (value === null || typeof value !== "object") return value;
  if (typeof value.data === "string" && Array.isArray(value.shape)) return array(value);
  return Object.fromEntries(Object.entries(value).map(([key, x]) => [key, unpacked(x)]));
}

const scene = unpacked(JSON.parse(document.getElementById("scene").textContent));
const times = scene.t.numbers;
const first = times[0], last = times[times.length - 1];
// Numbers of a place and of a frame's motion.
const D = scene.dimension, POSE = D === 3 ? 7 : 3;
const still = times.length < 2 || last <= first;

// Where a time lies among the frames: after frame k, by the part x of the way to the next one. At a jump, where two
// frames have one time, it is the one after it.
function place(t) {
  let low = 0, high = times.length - 1;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (times[middle] <= t) low = middle; else high = middle - 1;
  }
  const next = Math.min(low + 1, times.length - 1), step = times[next] - times[low];
  return { k: low, x: step > 0 ? Math.min(Math.max((t - times[low]) / step, 0), 1) : 0 };
}

// Number `index` of the row at a place of an array (F, ...); what stands still has one row.
function at(packed, place, width, index) {
  const n = packed.numbers, rows = packed.shape[0];
  if (rows === 1) return n[index];
  const a = n[place.k * width + index];
  if (place.x === 0) return a;
  return a + place.x * (n[Math.min(place.k + 1, rows - 1) * width + index] - a);
}

// Of a frame: x, y and angle; in space its place and Euler parameters.
function pose(frame, where) {
  const m = scene.frames[frame].motion;
  return Array.from({ length: POSE }, (_, k) => at(m, where, POSE, k));
}

// A point of a frame in the inertial frame.
function anchored(anchor, where) {
  if (D === 3) return turnedBy(pose(anchor.frame, where), anchor.point);
  const [x, y, angle] = pose(anchor.frame, where), c = Math.cos(angle), s = Math.sin(angle), [u, w] = anchor.point;
  return [x + c * u - s * w, y + s * u + c * w];
}

// A point of a frame that has this place and these Euler parameters.
function turnedBy([x, y, z, e0, e1, e2, e3], [u, v, w]) {
  const norm = 2 / (e0 * e0 + e1 * e1 + e2 * e2 + e3 * e3);
  const a = e2 * w - e3 * v + e0 * u, b = e3 * u - e1 * w + e0 * v, c = e1 * v - e2 * u + e0 * w;
  return [x + u + norm * (e2 * c - e3 * b), y + v + norm * (e3 * a - e1 * c), z + w + norm * (e1 * b - e2 * a)];
}

// The largest of a list's numbers but for the topmost few, so that a short blow does not make all else invisible.
function usual(values) {
  const sorted = values.filter((v) => v > 0).sort((a, b) => a - b);
  return sorted.length ? sorted[Math.floor(0.95 * (sorted.length - 1))] : 0;
}

// A number with its unit in engineering manner: four digits, with k, M, m, u, n where the unit takes one.
function shown(value, unit) {
  if (!Number.isFinite(value)) return "–";
  const known = ["N", "m", "m/s", "J", "N.m", "N.s", "N.m.s", "Pa", "s"].includes(unit);
  const size = Math.abs(value);
  if (known && size >= 1e-12 && (size >= 1e4 || size < 1e-2)) {
    const power = Math.max(-4, Math.min(3, Math.floor(Math.log10(size) / 3)));
    const prefix = ["p", "n", "µ", "m", "", "k", "M", "G"][power + 4];
    return `${Number((value / 10 ** (3 * power)).toPrecision(4))} ${prefix}${unit}`.replace("-", "−");
  }
  const text = size !== 0 && (size >= 1e5 || size < 1e-3) ? value.toExponential(2) : String(Number(value.toPrecision(4)));
  return `${text}${unit && unit !== "1" && unit !== "-" ? " " + unit : ""}`.replace("-", "−");
}

// 1, 2 or 5 times a power of ten, at most `value`.
function round(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  return [5, 2, 1].find((n) => n * power <= value * (1 + 1e-9)) * power;
}
