// Embree's side of `cargo bench --bench tree -- --write FOLDER`: the same mesh from FOLDER, the same laws of rays, one thread.
//   g++ -O3 -march=native benches/peers/embree.cpp -lembree3 -o embree && cd FOLDER && embree threads=1
// Debian's package is libembree-dev. Medians; compare only within one run.
#include <embree3/rtcore.h>
#include <pmmintrin.h>
#include <xmmintrin.h>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <random>
#include <vector>

typedef std::chrono::steady_clock Clock;

static double since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

template <class T> static std::vector<T> read(const char *path) {
    FILE *file = fopen(path, "rb");
    if (!file) { fprintf(stderr, "%s: not there; see the top of embree.cpp\n", path); exit(2); }
    fseek(file, 0, SEEK_END);
    std::vector<T> all(ftell(file) / sizeof(T));
    rewind(file);
    if (fread(all.data(), sizeof(T), all.size(), file) != all.size()) exit(2);
    fclose(file);
    return all;
}

struct Ray { float o[3], d[3]; };

static RTCIntersectContext context(bool coherent) {
    RTCIntersectContext c;
    rtcInitIntersectContext(&c);
    c.flags = coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    return c;
}

static void report(const char *what, const char *how, size_t rays, std::vector<double> seconds, long hits) {
    std::sort(seconds.begin(), seconds.end());
    double t = seconds[seconds.size() / 2];
    printf("  %-22s %-22s %7.2f M rays/s (%.0f ns a ray, %.1f %% hit)\n", what, how, rays / t / 1e6, t / rays * 1e9, 100.0 * hits / rays);
}

static void alone(RTCScene scene, const std::vector<Ray> &rays, const char *what, bool coherent) {
    std::vector<double> seconds;
    long hits = 0;
    for (int round = 0; round < 7; round++) {
        hits = 0;
        auto start = Clock::now();
        for (auto &r : rays) {
            RTCRayHit h;
            h.ray.org_x = r.o[0]; h.ray.org_y = r.o[1]; h.ray.org_z = r.o[2];
            h.ray.dir_x = r.d[0]; h.ray.dir_y = r.d[1]; h.ray.dir_z = r.d[2];
            h.ray.tnear = 0; h.ray.tfar = INFINITY; h.ray.mask = -1; h.ray.flags = 0; h.ray.time = 0;
            h.hit.geomID = h.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
            auto c = context(coherent);
            rtcIntersect1(scene, &c, &h);
            hits += h.hit.geomID != RTC_INVALID_GEOMETRY_ID;
        }
        seconds.push_back(since(start));
    }
    report(what, "alone", rays.size(), seconds, hits);
}

static void together(RTCScene scene, const std::vector<Ray> &rays, const char *what, bool coherent) {
    alignas(64) int valid[16];
    for (int &v : valid) v = -1;
    std::vector<double> seconds;
    long hits = 0;
    for (int round = 0; round < 7; round++) {
        hits = 0;
        auto start = Clock::now();
        for (size_t first = 0; first + 16 <= rays.size(); first += 16) {
            alignas(64) RTCRayHit16 h;
            for (int i = 0; i < 16; i++) {
                const Ray &r = rays[first + i];
                h.ray.org_x[i] = r.o[0]; h.ray.org_y[i] = r.o[1]; h.ray.org_z[i] = r.o[2];
                h.ray.dir_x[i] = r.d[0]; h.ray.dir_y[i] = r.d[1]; h.ray.dir_z[i] = r.d[2];
                h.ray.tnear[i] = 0; h.ray.tfar[i] = INFINITY; h.ray.mask[i] = -1; h.ray.flags[i] = 0; h.ray.time[i] = 0;
                h.hit.geomID[i] = h.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
            }
            auto c = context(coherent);
            rtcIntersect16(valid, scene, &c, &h);
            for (int i = 0; i < 16; i++) hits += h.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID;
        }
        seconds.push_back(since(start));
    }
    report(what, "16 at a time", rays.size(), seconds, hits);
}

int main(int argc, char **argv) {
    _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
    _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
    auto vertices = read<float>("mesh.v.f32");
    auto faces = read<unsigned>("mesh.f.u32");
    RTCDevice device = rtcNewDevice(argc > 1 ? argv[1] : "threads=1");
    RTCScene scene = nullptr;
    std::vector<double> built;
    for (int round = 0; round < 5; round++) {
        if (scene) rtcReleaseScene(scene);
        scene = rtcNewScene(device);
        auto mesh = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
        void *v = rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, vertices.size() / 3);
        void *f = rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, faces.size() / 3);
        memcpy(v, vertices.data(), vertices.size() * 4);
        memcpy(f, faces.data(), faces.size() * 4);
        auto start = Clock::now();
        rtcCommitGeometry(mesh);
        rtcAttachGeometry(scene, mesh);
        rtcReleaseGeometry(mesh);
        rtcCommitScene(scene);
        built.push_back(since(start));
    }
    std::sort(built.begin(), built.end());
    printf("mesh of %zu triangles: %.1f ms to build\n", faces.size() / 3, built[2] * 1e3);

    // From the eye (0, 5, 14) towards the middle, in tiles of 4 x 4 pixels.
    const int width = 1280, height = 720;
    const float eye[3] = {0, 5, 14}, far = std::sqrt(25 + 196.f), w[3] = {0, -5 / far, -14 / far};
    const float u[3] = {1, 0, 0}, v[3] = {0, -w[2], w[1]};
    std::vector<Ray> camera;
    for (int y = 0; y < height; y += 4)
        for (int x = 0; x < width; x += 4)
            for (int k = 0; k < 16; k++) {
                float sx = (2 * (x + k % 4 + .5f) / width - 1) * .25f * 16 / 9, sy = (1 - 2 * (y + k / 4 + .5f) / height) * .25f;
                Ray r;
                float n = 0;
                for (int i = 0; i < 3; i++) {
                    r.o[i] = eye[i];
                    r.d[i] = w[i] + sx * u[i] + sy * v[i];
                    n += r.d[i] * r.d[i];
                }
                for (float &x : r.d) x /= std::sqrt(n);
                camera.push_back(r);
            }
    // From anywhere in the mesh's box, in any direction.
    float lo[3] = {1e9, 1e9, 1e9}, hi[3] = {-1e9, -1e9, -1e9};
    for (size_t i = 0; i < vertices.size(); i++) {
        lo[i % 3] = std::min(lo[i % 3], vertices[i]);
        hi[i % 3] = std::max(hi[i % 3], vertices[i]);
    }
    std::mt19937 lot(1);
    std::uniform_real_distribution<float> unit(0, 1);
    std::vector<Ray> random(1 << 20);
    for (auto &r : random) {
        for (int i = 0; i < 3; i++) r.o[i] = lo[i] + (hi[i] - lo[i]) * unit(lot);
        float z = 2 * unit(lot) - 1, p = 6.2831853f * unit(lot), e = std::sqrt(std::max(0.f, 1 - z * z));
        r.d[0] = e * std::cos(p); r.d[1] = e * std::sin(p); r.d[2] = z;
    }
    alone(scene, camera, "camera rays", true);
    together(scene, camera, "camera rays", true);
    alone(scene, random, "random rays", false);
    together(scene, random, "random rays", false);
}
