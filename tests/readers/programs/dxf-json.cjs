// The package `dxf-json`: entities as they come, angles in degrees, those of blocks where the blocks are inserted.
const {DxfParser} = require('dxf-json');
const RADIANS = Math.PI / 180;
function piece(one) {
  if (one.type === 'CIRCLE' || one.type === 'ARC') {
    const angles = one.type === 'ARC' ? {from: one.startAngle * RADIANS, to: one.endAngle * RADIANS} : {};
    return {layer: one.layer, center: [one.center.x, one.center.y], radius: one.radius, ...angles};
  }
  if (one.type === 'LINE') {
    return {layer: one.layer, points: [one.startPoint, one.endPoint].map((at) => [at.x, at.y])};
  }
  const points = one.vertices.map((at) => [at.x, at.y]);
  return {layer: one.layer, points, bulges: one.vertices.map((at) => at.bulge || 0), closed: Boolean(one.flag & 1)};
}
const {drawn, print} = require('./answers.cjs');
print((text) => {
  const file = new DxfParser().parseSync(text);
  const every = drawn(file);
  return {
    unit: file.header.$INSUNITS,
    entities: every.filter((one) => one.type !== 'TEXT').map(piece),
    texts: every.filter((one) => one.type === 'TEXT').map((one) => one.text),
  };
});
