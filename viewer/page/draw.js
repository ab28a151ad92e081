// The picture at one time.

const FLEX_EDGE = "#123f30", TOUCH = "#b3402a", PAPER = "#fbfcfe";

function sized() {}

function drawScene(g, time) {
  const where = place(time), u = 0.01 * scene.size * camera.scale;
  if (camera.follow) {
    const [x, y] = pose(camera.follow, where);
    camera.x = x;
    camera.y = y;
  }
  g.fillStyle = PAPER;
  g.fillRect(0, 0, camera.width, camera.height);
  g.lineJoin = g.lineCap = "round";
  drawGrid(g);
  if (shows.trails && !still) drawTrails(g, where);
  drawParts(g, 0, where, u);
  for (const band of scene.bands) drawBand(g, band, where, u);
  drawParts(g, 1, where, u);
  for (const line of scene.lines) drawLine(g, line, where, u);
  for (const link of scene.links) {
    drawLink(g, link.kind, toScreen(anchored(link.a, where)), toScreen(anchored(link.b, where)), u);
  }
  drawParts(g, 2, where, u);
  drawGauges(g, where);
  if (shows.names) drawNames(g, where);
  if (shows.velocities) drawVelocities(g, where);
  drawForces(g, where, time);
  drawScale(g);
}

function drawParts(g, layer, where, u) {
  for (const part of scene.parts) {
    if (part.layer !== layer) continue;
    const [x, y, angle] = pose(part.frame, where), c = Math.cos(angle), s = Math.sin(angle);
    for (const shape of part.shapes) {
      g.beginPath();
      if (shape.kind === "circle") {
        const [px, py] = toScreen([x + c * shape.centre[0] - s * shape.centre[1], y + s * shape.centre[0] + c * shape.centre[1]]);
        g.arc(px, py, Math.max(shape.radius * camera.scale, 1), 0, 2 * Math.PI);
      } else {
        shape.points.forEach(([a, b], k) => {
          const [px, py] = toScreen([x + c * a - s * b, y + s * a + c * b]);
          if (k) g.lineTo(px, py); else g.moveTo(px, py);
        });
        if (shape.closed) g.closePath();
      }
      if (shape.fill) {
        g.fillStyle = shape.fill;
        g.fill();
      }
      if (shape.stroke) {
        g.strokeStyle = shape.stroke;
        g.lineWidth = Math.max(shape.width * u, 0.8);
        g.setLineDash(shape.dashed ? [2 * u, 2 * u] : []);
        g.stroke();
        g.setLineDash([]);
      }
    }
  }
}

// A line rounded at its vertices: the quadratic pieces of `Line2D`.
function drawLine(g, line, where, u) {
  const p = line.nodes.map((node) => toScreen(anchored(node, where))), n = p.length, part = 0.5 * line.rounding;
  const mix = (a, b, x) => [a[0] + x * (b[0] - a[0]), a[1] + x * (b[1] - a[1])];
  g.beginPath();
  const vertices = line.closed ? [...p.keys()] : [...p.keys()].slice(1, -1);
  if (line.closed) g.moveTo(...mix(p[0], p[n - 1], part)); else g.moveTo(...p[0]);
  for (const k of vertices) {
    const before = p[(k + n - 1) % n], after = p[(k + 1) % n];
    g.lineTo(...mix(p[k], before, part));
    g.quadraticCurveTo(...p[k], ...mix(p[k], after, part));
  }
  if (line.closed) g.closePath(); else g.lineTo(...p[n - 1]);
  g.strokeStyle = TOUCH;
  g.lineWidth = Math.max(line.thickness * camera.scale, 0.6 * u, 1.5);
  g.stroke();
}

function drawBand(g, band, where, u) {
  const count = band.points.shape[1], thick = Math.max(band.width * u, 3), points = [];
  for (let k = 0; k < count; k++) points.push(toScreen(bandPoint(band, where, k)));
  g.lineCap = "butt";
  strokeLine(g, lengthened(points, 1.2), FLEX_EDGE, thick + 2.4);
  const field = band.fields[chosen.get(band)];
  if (!field) {
    strokeLine(g, points, FLEX, thick);
  } else {
    const values = [];
    for (let k = 0; k < count; k++) values.push(at(field.values, where, count, k));
    for (let k = 0; k + 1 < count; k++) {
      const piece = k + 2 < count ? [points[k], points[k + 1], nudge(points[k + 1], points[k + 2])] : [points[k], points[k + 1]];
      strokeLine(g, piece, colour((0.5 * (values[k] + values[k + 1])) / field.limit), thick);
    }
  }
  g.lineCap = "round";
}

// A little into the next piece: no gaps are seen between them.
function nudge(a, b) {
  const d = Math.hypot(b[0] - a[0], b[1] - a[1]) || 1;
  return [a[0] + (0.7 * (b[0] - a[0])) / d, a[1] + (0.7 * (b[1] - a[1])) / d];
}

function lengthened(points, by) {
  const out = (a, b) => {
    const d = Math.hypot(a[0] - b[0], a[1] - b[1]) || 1;
    return [a[0] + (by * (a[0] - b[0])) / d, a[1] + (by * (a[1] - b[1])) / d];
  };
  const n = points.length;
  return [out(points[0], points[1]), ...points.slice(1, -1), out(points[n - 1], points[n - 2])];
}

function drawGrid(g) {
  const step = round(110 / camera.scale);
  g.lineWidth = 1;
  g.strokeStyle = "#e9edf2";
  g.beginPath();
  const x0 = camera.x - (0.5 * camera.width) / camera.scale, y0 = camera.y - (0.5 * camera.height) / camera.scale;
  for (let k = Math.ceil(x0 / step); toScreen([k * step, 0])[0] < camera.width; k++) {
    const x = Math.round(toScreen([k * step, 0])[0]) + 0.5;
    g.moveTo(x, 0);
    g.lineTo(x, camera.height);
  }
  for (let k = Math.ceil(y0 / step); toScreen([0, k * step])[1] > 0; k++) {
    const y = Math.round(toScreen([0, k * step])[1]) + 0.5;
    g.moveTo(0, y);
    g.lineTo(camera.width, y);
  }
  g.stroke();
}
