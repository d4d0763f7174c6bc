"use strict";
/* What the player draws: the ground, the paths on it, the skeleton and its shadow. */

function drawGround(context, eye, { colour, reach, cell, fading }) {
  const [x0, z0] = [eye.target[0], eye.target[2]].map((value) => Math.round(value / cell) * cell);
  const lines = Math.ceil(reach / cell);
  context.strokeStyle = colour;
  context.lineWidth = 1;
  for (let k = -lines; k <= lines; k += 1) {
    const [x, z] = [x0 + k * cell, z0 + k * cell];
    context.globalAlpha = fading ? Math.max(0, 1 - Math.abs(k * cell) / reach) : 0.7;
    context.beginPath();
    eye.line(context, eye.seen(x, 0, z0 - reach), eye.seen(x, 0, z0 + reach));
    eye.line(context, eye.seen(x0 - reach, 0, z), eye.seen(x0 + reach, 0, z));
    context.stroke();
  }
  context.globalAlpha = 1;
}

/* Points (x, z) on the ground from one step to another, every `stride`th of them. */
function drawWay(context, eye, points, from, to, stride) {
  context.beginPath();
  let last = eye.seen(points[from * 2], 0, points[from * 2 + 1]);
  for (let step = from + stride; step < to + stride; step += stride) {
    const at = Math.min(step, to);
    const next = eye.seen(points[at * 2], 0, points[at * 2 + 1]);
    eye.line(context, last, next);
    last = next;
  }
  context.stroke();
}

function drawRing(context, eye, x, z, radius) {
  context.beginPath();
  for (let k = 0; k < 24; k += 1) {
    const [a, b] = [k, k + 1].map((place) => (place / 12) * Math.PI);
    eye.line(context, eye.seen(x + radius * Math.sin(a), 0, z + radius * Math.cos(a)),
      eye.seen(x + radius * Math.sin(b), 0, z + radius * Math.cos(b)));
  }
  context.stroke();
}

function drawShadow(context, eye, pose, parents, colour) {
  context.lineCap = "round";
  context.globalAlpha = 0.13;
  context.strokeStyle = colour;
  context.lineWidth = Math.max(2, (0.09 * eye.focal) / eye.distance);
  context.beginPath();
  parents.forEach((parent, joint) => {
    if (parent < 0) return;
    eye.line(context, eye.seen(pose[parent * 3], 0, pose[parent * 3 + 2]),
      eye.seen(pose[joint * 3], 0, pose[joint * 3 + 2]));
  });
  context.stroke();
  context.globalAlpha = 1;
}

/* Bones from the farthest to the nearest, each with an edge that parts it from what is behind it. */
function drawSkeleton(context, eye, pose, { parents, sides, head }, colours) {
  const bones = [];
  parents.forEach((parent, joint) => {
    if (parent < 0) return;
    const [a, b] = [parent, joint].map((end) => eye.seen(...pose.subarray(end * 3, end * 3 + 3)));
    if (Math.min(a[2], b[2]) > NEAR) bones.push({ a, b, side: sides[joint], depth: (a[2] + b[2]) / 2 });
  });
  bones.sort((first, second) => second.depth - first.depth);
  const limb = [colours.ink, colours.left, colours.right];
  for (const { a, b, side, depth } of bones) {
    const width = Math.max(2, (0.062 * eye.focal) / depth);
    for (const [cap, colour, extra] of [["butt", colours.panel, 2.5], ["round", limb[side], 0]]) {
      context.lineCap = cap;
      context.strokeStyle = colour;
      context.lineWidth = width + extra;
      context.beginPath();
      context.moveTo(...eye.drawn(a));
      context.lineTo(...eye.drawn(b));
      context.stroke();
    }
  }
  context.lineCap = "butt";
  if (head.length) drawHead(context, eye, pose, head, colours.ink);
}

function drawHead(context, eye, pose, [joint, tip], colour) {
  const lift = joint === tip ? 0.08 : 0;
  const [x, y, z] = [0, 1, 2].map((axis) => (pose[joint * 3 + axis] + pose[tip * 3 + axis]) / 2);
  const seen = eye.seen(x, y + lift, z);
  if (seen[2] <= NEAR) return;
  context.fillStyle = colour;
  context.beginPath();
  context.arc(...eye.drawn(seen), Math.max(2, (0.1 * eye.focal) / seen[2]), 0, 2 * Math.PI);
  context.fill();
}
