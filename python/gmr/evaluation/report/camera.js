"use strict";
/* Where a camera that turns about a point sees things: world to camera space, and that to the canvas. */

const NEAR = 0.2;

/* turn and tilt in radians, metres elsewhere; `middle` is the height of the target on the canvas, 0 at its top. */
function eyeOf({ turn, tilt, distance, target, middle, width, height }) {
  const focal = Math.min(width, height * 1.2) * 1.15;
  const [sinTurn, cosTurn, sinTilt, cosTilt] = [Math.sin(turn), Math.cos(turn), Math.sin(tilt), Math.cos(tilt)];

  /* Camera space: x to the right, y up, z away from the eye. The world's +X is left of its +Z, so x is mirrored. */
  function seen(x, y, z) {
    const dx = x - target[0], dy = y - target[1], dz = z - target[2];
    const along = dx * sinTurn + dz * cosTurn;
    return [-(dx * cosTurn - dz * sinTurn), dy * cosTilt + along * sinTilt,
      distance + along * cosTilt - dy * sinTilt];
  }

  function drawn([x, y, depth]) {
    return [width / 2 + (x / depth) * focal, height * middle - (y / depth) * focal];
  }

  /* Adds the line between two seen points to the context's path, cut where it comes behind the eye. */
  function line(context, a, b) {
    if (a[2] < NEAR && b[2] < NEAR) return;
    const cut = (from, to) => {
      if (from[2] >= NEAR) return from;
      const part = (NEAR - from[2]) / (to[2] - from[2]);
      return from.map((value, axis) => value + part * (to[axis] - value));
    };
    context.moveTo(...drawn(cut(a, b)));
    context.lineTo(...drawn(cut(b, a)));
  }

  return { focal, distance, target, seen, drawn, line };
}
