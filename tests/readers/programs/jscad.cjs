// jscad's deserializer: shapes in mm by the unit of the file; circles and arcs are sides of polygons.
const {deserialize} = require('@jscad/dxf-deserializer');
function ring(sides) {
  return [...sides.map((side) => side[0]), sides[sides.length - 1][1]];
}
function piece(one) {
  if (one.sides) return {layer: '', points: ring(one.sides)};
  return {layer: '', points: one.points, closed: one.isClosed};
}
require('./answers.cjs').print((text) => ({
  entities: deserialize({output: 'geometry', strict: false}, text).filter((one) => one.sides || one.points).map(piece),
}));
