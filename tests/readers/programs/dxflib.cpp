// dxflib: what it calls for each entity, printed as JSON.
#include <dl_creationadapter.h>
#include <dl_dxf.h>

#include <cstdio>
#include <string>
#include <vector>

namespace {

const double RADIANS = 3.14159265358979323846 / 180.0;

std::string number(double value) {
    char text[40];
    std::snprintf(text, sizeof text, "%.17g", value);
    return text;
}

std::string quoted(const std::string& text) { return "\"" + text + "\""; }

class Listener : public DL_CreationAdapter {
  public:
    std::vector<std::string> entities, texts;
    int unit = 0;

    void addLine(const DL_LineData& line) override {
        entities.push_back(head() + "\"points\": [" + point(line.x1, line.y1) + ", " + point(line.x2, line.y2) + "]}");
    }
    void addArc(const DL_ArcData& arc) override {
        entities.push_back(round(arc.cx, arc.cy, arc.radius) + ", \"from\": " + number(arc.angle1 * RADIANS) +
                           ", \"to\": " + number(arc.angle2 * RADIANS) + "}");
    }
    void addCircle(const DL_CircleData& circle) override {
        entities.push_back(round(circle.cx, circle.cy, circle.radius) + "}");
    }
    void addPolyline(const DL_PolylineData& line) override {
        closed = line.flags & 1;
        start = head();
        points = bulges = "";
    }
    void addVertex(const DL_VertexData& vertex) override {
        points += (points.empty() ? "" : ", ") + point(vertex.x, vertex.y);
        bulges += (bulges.empty() ? "" : ", ") + number(vertex.bulge);
    }
    void endEntity() override {
        if (!points.empty()) {
            entities.push_back(start + "\"points\": [" + points + "], \"bulges\": [" + bulges +
                               "], \"closed\": " + (closed ? "true" : "false") + "}");
        }
        points = "";
    }
    void addText(const DL_TextData& text) override { texts.push_back(quoted(text.text)); }
    void setVariableInt(const std::string& key, int value, int) override {
        if (key == "$INSUNITS") unit = value;
    }

  private:
    bool closed = false;
    std::string start, points, bulges;

    std::string head() { return "{\"layer\": " + quoted(attributes.getLayer()) + ", "; }
    static std::string point(double x, double y) { return "[" + number(x) + ", " + number(y) + "]"; }
    std::string round(double x, double y, double radius) {
        return head() + "\"center\": " + point(x, y) + ", \"radius\": " + number(radius);
    }
};

std::string joined(const std::vector<std::string>& some) {
    std::string text;
    for (const std::string& one : some) text += (text.empty() ? "" : ", ") + one;
    return "[" + text + "]";
}

}  // namespace

int main(int count, char** paths) {
    std::string answers;
    for (int i = 1; i < count; ++i) {
        Listener listener;
        DL_Dxf reader;
        if (!reader.in(std::string(paths[i]), &listener)) return 1;
        answers += (answers.empty() ? "" : ", ") + quoted(paths[i]) + ": {\"unit\": " + std::to_string(listener.unit) +
                   ", \"entities\": " + joined(listener.entities) + ", \"texts\": " + joined(listener.texts) + "}";
    }
    std::printf("{%s}\n", answers.c_str());
    return 0;
}
