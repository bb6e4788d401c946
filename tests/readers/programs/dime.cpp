// dime: its own geometry of each entity, points and the lines between them, printed as JSON.
#include <dime/Input.h>
#include <dime/Layer.h>
#include <dime/Model.h>
#include <dime/State.h>
#include <dime/entities/Entity.h>
#include <dime/entities/Text.h>
#include <dime/util/Array.h>
#include <dime/util/Linear.h>

#include <cstdio>
#include <cstring>
#include <string>

namespace {

struct Found {
    std::string entities, texts;
};

std::string number(double value) {
    char text[40];
    std::snprintf(text, sizeof text, "%.17g", value);
    return text;
}

bool visit(const dimeState* const, dimeEntity* entity, void* into) {
    Found* found = static_cast<Found*>(into);
    if (std::strcmp(entity->getEntityName(), "TEXT") == 0) {
        const std::string text = static_cast<dimeText*>(entity)->getTextString();
        found->texts += (found->texts.empty() ? "\"" : ", \"") + text + "\"";
        return true;
    }
    dimeArray<dimeVec3f> points;
    dimeArray<int> indices;
    dimeVec3f extrusion(0, 0, 1);
    dxfdouble thickness = 0;
    if (entity->extractGeometry(points, indices, extrusion, thickness) != dimeEntity::LINES) return true;
    std::string line;
    for (int i = 0; i < indices.count(); ++i) {
        if (indices[i] < 0) continue;
        const dimeVec3f& at = points[indices[i]];
        line += (line.empty() ? "[" : ", [") + number(at[0]) + ", " + number(at[1]) + "]";
    }
    if (indices.count() == 0) {
        for (int i = 0; i < points.count(); ++i) {
            line += (line.empty() ? "[" : ", [") + number(points[i][0]) + ", " + number(points[i][1]) + "]";
        }
    }
    found->entities += std::string(found->entities.empty() ? "" : ", ") + "{\"layer\": \"" + entity->getLayerName() +
                       "\", \"points\": [" + line + "]}";
    return true;
}

}  // namespace

int main(int count, char** paths) {
    std::string answers;
    for (int i = 1; i < count; ++i) {
        dimeInput input;
        dimeModel model;
        Found found;
        if (!input.setFile(paths[i]) || !model.read(&input)) return 1;
        model.traverseEntities(visit, &found);
        answers += std::string(answers.empty() ? "" : ", ") + "\"" + paths[i] + "\": {\"entities\": [" + found.entities +
                   "], \"texts\": [" + found.texts + "]}";
    }
    std::printf("{%s}\n", answers.c_str());
    return 0;
}
