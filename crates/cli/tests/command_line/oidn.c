/* A library with the functions of Open Image Denoise 2 that the filter `oidn` calls. It makes of
   each pixel the mean of the 7x7 about it, and fails where it is not called as it must be. */

#include <stdbool.h>
#include <stddef.h>
#include <string.h>

struct image {
    float *pixels;
    size_t width, height;
};

static struct filter {
    struct image color, albedo, normal, output;
    bool is_hdr, is_committed;
} filter;

static bool is_device_committed;
static const char *message;
static int device;

void *oidnNewDevice(int type) {
    memset(&filter, 0, sizeof filter);
    is_device_committed = false;
    message = type == 1 ? NULL : "no such device";
    return type == 1 ? &device : NULL;
}

void oidnCommitDevice(void *of) { is_device_committed = of == &device; }
void oidnReleaseDevice(void *of) { (void)of; }

int oidnGetDeviceError(void *of, const char **text) {
    (void)of;
    *text = message;
    return message ? 1 : 0;
}

void *oidnNewFilter(void *of, const char *type) {
    bool is_known = of == &device && is_device_committed && strcmp(type, "RT") == 0;
    return is_known ? &filter : NULL;
}

void oidnSetSharedFilterImage(void *of, const char *name, void *pixels, int format, size_t width,
                              size_t height, size_t first, size_t pixel, size_t row) {
    struct image image = {pixels, width, height};
    if (of != &filter || format != 3 || first || pixel || row) message = "not as it must be";
    else if (strcmp(name, "color") == 0) filter.color = image;
    else if (strcmp(name, "albedo") == 0) filter.albedo = image;
    else if (strcmp(name, "normal") == 0) filter.normal = image;
    else if (strcmp(name, "output") == 0) filter.output = image;
    else message = "no such image";
}

void oidnSetFilterBool(void *of, const char *name, bool value) {
    if (of == &filter && strcmp(name, "hdr") == 0) filter.is_hdr = value;
}

void oidnCommitFilter(void *of) { filter.is_committed = of == &filter; }
void oidnReleaseFilter(void *of) { (void)of; }

void oidnExecuteFilter(void *of) {
    struct image in = filter.color, out = filter.output;
    if (of != &filter || !filter.is_committed || !filter.is_hdr || !out.pixels || !in.pixels) {
        message = "not as it must be";
        return;
    }
    if (in.width == 13) {
        message = "unlucky width";
        return;
    }
    for (long y = 0; y < (long)in.height; y++)
        for (long x = 0; x < (long)in.width; x++)
            for (int c = 0; c < 3; c++) {
                float sum = 0, count = 0;
                for (long v = y - 3; v <= y + 3; v++)
                    for (long u = x - 3; u <= x + 3; u++)
                        if (u >= 0 && v >= 0 && u < (long)in.width && v < (long)in.height) {
                            sum += in.pixels[(v * in.width + u) * 3 + c];
                            count++;
                        }
                out.pixels[(y * in.width + x) * 3 + c] = sum / count;
            }
}
