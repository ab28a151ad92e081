// What part of the plane the picture shows.

const camera = { x: 0, y: 0, scale: 1, width: 1, height: 1, moved: false, follow: 0 };

function fit() {
  const [x0, y0, x1, y1] = scene.box;
  const least = 0.25 * scene.size;
  const wide = Math.max(x1 - x0, least), high = Math.max(y1 - y0, least);
  // room for the buttons above, the scale below, and gauges if there are any
  const gauged = scene.gauges.length && (scene.frames.length > 1 || scene.bands.length);
  const margin = { x: 34, top: camera.width < 600 ? 92 : 52, bottom: gauged ? 190 : 44 };
  camera.scale = Math.min((camera.width - 2 * margin.x) / wide, (camera.height - margin.top - margin.bottom) / high);
  camera.scale = Math.max(camera.scale, 1e-9);
  camera.x = 0.5 * (x0 + x1);
  camera.y = 0.5 * (y0 + y1) + (0.5 * (margin.top - margin.bottom)) / camera.scale;
  camera.moved = false;
}

function toScreen(p) {
  return [0.5 * camera.width + (p[0] - camera.x) * camera.scale, 0.5 * camera.height - (p[1] - camera.y) * camera.scale];
}

function zoomAt(px, py, factor) {
  const x = camera.x + (px - 0.5 * camera.width) / camera.scale, y = camera.y - (py - 0.5 * camera.height) / camera.scale;
  camera.scale *= factor;
  camera.x = x - (px - 0.5 * camera.width) / camera.scale;
  camera.y = y + (py - 0.5 * camera.height) / camera.scale;
  camera.moved = true;
}

function pan(dx, dy) {
  camera.x -= dx / camera.scale;
  camera.y += dy / camera.scale;
  camera.moved = true;
}

// What a drag by (dx, dy) pixels does.
function dragged(dx, dy) {
  pan(dx, dy);
}
