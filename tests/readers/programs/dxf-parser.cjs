// The package `dxf-parser`: entities as they come, those of blocks where the blocks are inserted.
const Parser = require('dxf-parser');
function piece(one) {
  if (one.type === 'CIRCLE' || one.type === 'ARC') {
    const angles = one.type === 'ARC' ? {from: one.startAngle, to: one.endAngle} : {};
    return {layer: one.layer, center: [one.center.x, one.center.y], radius: one.radius, ...angles};
  }
  const points = one.vertices.map((at) => [at.x, at.y]);
  return {layer: one.layer, points, bulges: one.vertices.map((at) => at.bulge || 0), closed: Boolean(one.shape)};
}
const {drawn, print} = require('./answers.cjs');
print((text) => {
  const file = new Parser().parseSync(text);
  const every = drawn(file);
  return {
    unit: file.header.$INSUNITS,
    entities: every.filter((one) => one.type !== 'TEXT').map(piece),
    texts: every.filter((one) => one.type === 'TEXT').map((one) => one.text),
  };
});
