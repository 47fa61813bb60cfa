#include "figures/animation.hpp"

#include "base/child_process.hpp"
#include "base/error.hpp"
#include "base/whole_file.hpp"

#include <cairo.h>
#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>
#include <webp/encode.h>
#include <webp/mux.h>

#include <array>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <sstream>
#include <utility>
#include <vector>

namespace knap {
namespace {

using std::filesystem::path;

constexpr float quality = 80;                   // of pictures with many colours
constexpr int effort = 3, effort_of_still = 2;  // of 6: more takes longer and saves some percent
constexpr int film_rate = 25;                   // [1/s] pictures of .gif and .mp4
constexpr const char* encoder_name = "ffmpeg";

int width_of(const Image& image) { return cairo_image_surface_get_width(image.get()); }
int height_of(const Image& image) { return cairo_image_surface_get_height(image.get()); }

Image blank(int width, int height) {
    Image page(cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height), cairo_surface_destroy);
    cairo_t* cairo = cairo_create(page.get());
    cairo_set_source_rgb(cairo, 1, 1, 1);
    cairo_paint(cairo);
    cairo_destroy(cairo);
    return page;
}

void place(const Image& image, const Image& page, int top) {
    cairo_t* cairo = cairo_create(page.get());
    cairo_set_source_surface(cairo, image.get(), 0, top);
    cairo_paint(cairo);
    cairo_destroy(cairo);
    cairo_surface_flush(page.get());
}

/// On a page of another height: the axes of a figure stand at the bottom.
Image with_height(Image image, int height) {
    if (height_of(image) == height) return image;
    Image page = blank(width_of(image), height);
    place(image, page, height - height_of(image));
    return page;
}

// ---- .webp

class WebpImage {
public:
    explicit WebpImage(const Image& image) {
        WebPPictureInit(&picture_);
        picture_.use_argb = 1;
        picture_.width = width_of(image), picture_.height = height_of(image);
        if (!WebPPictureAlloc(&picture_)) throw std::bad_alloc();
        const unsigned char* const data = cairo_image_surface_get_data(image.get());
        const int stride = cairo_image_surface_get_stride(image.get());
        for (int y = 0; y < picture_.height; ++y) {
            std::uint32_t* const row = picture_.argb + static_cast<std::ptrdiff_t>(y) * picture_.argb_stride;
            std::memcpy(row, data + static_cast<std::ptrdiff_t>(y) * stride, 4 * picture_.width);
            for (int x = 0; x < picture_.width; ++x) row[x] |= 0xff000000u;
        }
    }
    ~WebpImage() { WebPPictureFree(&picture_); }
    WebpImage(const WebpImage&) = delete;
    WebpImage& operator=(const WebpImage&) = delete;
    WebPPicture* get() { return &picture_; }

private:
    WebPPicture picture_;
};

WebPConfig config() {
    WebPConfig config;
    WebPConfigInit(&config);
    config.quality = quality;
    config.method = effort;
    return config;
}

std::string encoded(WebpImage& picture) {
    WebPConfig how = config();
    how.method = effort_of_still;
    WebPMemoryWriter writer;
    WebPMemoryWriterInit(&writer);
    picture.get()->writer = WebPMemoryWrite;
    picture.get()->custom_ptr = &writer;
    const bool good = WebPEncode(&how, picture.get()) != 0;
    std::string bytes(reinterpret_cast<const char*>(writer.mem), writer.size);
    WebPMemoryWriterClear(&writer);
    if (!good) throw OutputError("cannot make a .webp picture");
    return bytes;
}

/// Drawings of lines are stored without loss, as what changes between two pictures. The pictures of a field are stored
/// whole: the encoder leaves out changes that are smaller than its error, and they would add up.
std::string animated_webp(std::size_t n, bool lines, const std::function<Still(std::size_t)>& still) {
    const auto fail = [](const char* why) { throw OutputError(std::string("cannot make a .webp: ") + why); };
    WebPAnimEncoderOptions options;
    WebPAnimEncoderOptionsInit(&options);
    options.kmin = 0, options.kmax = lines ? 0 : 1;
    WebPConfig each = config();
    each.lossless = lines ? 1 : 0;
    std::unique_ptr<WebPAnimEncoder, void (*)(WebPAnimEncoder*)> encoder(nullptr, WebPAnimEncoderDelete);
    double time = 0;  // [ms]
    for (std::size_t i = 0; i < n; ++i) {
        Still one = still(i);
        if (!encoder) encoder.reset(WebPAnimEncoderNew(width_of(one.image), height_of(one.image), &options));
        WebpImage picture(one.image);
        if (!encoder || !WebPAnimEncoderAdd(encoder.get(), picture.get(), static_cast<int>(std::lround(time)), &each))
            fail(encoder ? WebPAnimEncoderGetError(encoder.get()) : "no encoder");
        time += 1000 * one.seconds;
    }
    WebPAnimEncoderAdd(encoder.get(), nullptr, static_cast<int>(std::lround(time)), nullptr);
    WebPData data;
    WebPDataInit(&data);
    if (!WebPAnimEncoderAssemble(encoder.get(), &data)) fail(WebPAnimEncoderGetError(encoder.get()));
    std::string bytes(reinterpret_cast<const char*>(data.bytes), data.size);
    WebPDataClear(&data);
    return bytes;
}

// ---- .gif and .mp4

/// Empty where it is not installed.
path find_encoder() {
    std::istringstream places(std::getenv("PATH") ? std::getenv("PATH") : "");
    for (std::string place; std::getline(places, place, ':');)
        if (const path file = path(place) / encoder_name; !place.empty() && access(file.c_str(), X_OK) == 0)
            return file;
    return {};
}

/// A process that reads raw pictures from its standard input. Its output is kept for error messages.
class Encoder {
public:
    explicit Encoder(std::vector<std::string> words) {
        std::array<int, 2> in{}, out{};
        if (pipe2(in.data(), O_CLOEXEC) != 0 || pipe2(out.data(), O_CLOEXEC) != 0)
            throw OutputError(std::string("cannot make a pipe: ") + std::strerror(errno));
        const std::string file = words.front();
        // a group of its own: Ctrl-C ends the run, which then completes its files
        child_ = start_process(file.c_str(), std::move(words), in[0], out[1], [] { return setpgid(0, 0) == 0; });
        const int error = errno;
        close(in[0]), close(out[1]);
        in_ = in[1], output_ = out[0];
        if (child_ < 0) throw OutputError(std::string("cannot start ") + encoder_name + ": " + std::strerror(error));
    }
    ~Encoder() {
        close_input();
        close(output_);
        if (child_ > 0) waitpid(child_, nullptr, 0);
    }
    Encoder(const Encoder&) = delete;
    Encoder& operator=(const Encoder&) = delete;

    /// False once the process reads no more.
    bool take(const Image& image) {
        const int width = 4 * width_of(image), stride = cairo_image_surface_get_stride(image.get());
        const unsigned char* row = cairo_image_surface_get_data(image.get());
        for (int y = 0; y < height_of(image); ++y, row += stride)
            for (int done = 0; done < width;) {
                const ssize_t n = ::write(in_, row + done, static_cast<std::size_t>(width - done));
                if (n < 0 && errno != EINTR) return false;
                if (n > 0) done += static_cast<int>(n);
            }
        return true;
    }

    /// Returns the error message of the encoder; empty where it succeeded.
    std::string finish() {
        close_input();
        std::string text;
        std::array<char, 4096> part{};
        for (ssize_t n; (n = read(output_, part.data(), part.size())) > 0 || (n < 0 && errno == EINTR);)
            if (n > 0) text.append(part.data(), static_cast<std::size_t>(n));
        int status = 0;
        while (waitpid(child_, &status, 0) < 0 && errno == EINTR) {
        }
        child_ = -1;
        if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return "";
        return text.empty() ? "it ended early" : text.substr(0, 400);
    }

private:
    void close_input() {
        if (in_ >= 0) close(std::exchange(in_, -1));
    }
    pid_t child_ = -1;
    int in_ = -1, output_ = -1;
};

void make_film(const path& file, const path& written, std::size_t n, const std::function<Still(std::size_t)>& still) {
    const bool gif = file.extension() == ".gif";
    std::optional<Encoder> process;
    // an encoder that exits early must not end this program
    const auto before = std::signal(SIGPIPE, SIG_IGN);
    double shown = 0;  // [s]
    std::int64_t taken = 0;
    bool takes = true;
    for (std::size_t i = 0; i < n && takes; ++i) {
        const Still one = still(i);
        if (!process) {
            std::vector<std::string> words{
                find_encoder().string(),
                "-nostdin",
                "-loglevel",
                "error",
                "-y",
                "-f",
                "rawvideo",
                "-pix_fmt",
                "bgr0",
                "-s",
                std::to_string(width_of(one.image)) + "x" + std::to_string(height_of(one.image)),
                "-r",
                std::to_string(film_rate),
                "-i",
                "-"};
            if (gif)
                words.insert(words.end(), {"-vf",
                                           "split[a][b];[a]palettegen=stats_mode=full[p];[b][p]paletteuse="
                                           "dither=none:diff_mode=rectangle",
                                           "-f", "gif"});
            else
                words.insert(words.end(), {"-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2:color=white", "-c:v", "libx264",
                                           "-pix_fmt", "yuv420p", "-crf", "20", "-threads", "1", "-fflags", "+bitexact",
                                           "-flags:v", "+bitexact", "-movflags", "+faststart", "-f", "mp4"});
            words.push_back("file:" + written.string());
            process.emplace(words);
        }
        shown += one.seconds;
        for (const auto until = std::llround(shown * film_rate); (taken < until || taken == 0) && takes; ++taken)
            takes = process->take(one.image);
    }
    const std::string failure = process ? process->finish() : "no pictures";
    std::signal(SIGPIPE, before);
    if (!failure.empty()) throw OutputError("cannot write " + file.string() + ": " + encoder_name + ": " + failure);
}

}  // namespace

bool is_animation(const path& file) {
    const std::string ending = file.extension().string();
    return ending == ".webp" || ending == ".gif" || ending == ".mp4";
}

void check_animation(const path& file) {
    if (!is_animation(file))
        throw UserError("figure-file", "animations cannot be written as `" + file.filename().string() + "`",
                        "known endings: .webp, .gif, .mp4");
    if (file.extension() != ".webp" && find_encoder().empty())
        throw UserError(
            "no-ffmpeg", "`" + file.filename().string() + "` needs the program ffmpeg, which is not installed",
            "a name that ends in .webp, which needs nothing; or install ffmpeg (Debian: apt install ffmpeg)");
}

void write_animation(const path& file, std::size_t n, const std::function<Still(std::size_t)>& picture, bool lines) {
    check_animation(file);
    const int height = height_of(picture(n - 1).image);
    const auto still = [&](std::size_t i) {
        Still one = picture(i);
        one.image = with_height(std::move(one.image), height);
        return one;
    };
    if (file.extension() == ".webp") return write_whole_file(file, animated_webp(n, lines, still));
    write_whole_file(file, [&](const path& written) { make_film(file, written, n, still); });
}

std::string webp_of(const Image& image) {
    WebpImage picture(image);
    return encoded(picture);
}

std::string webp_of_png(const path& file, int width) {
    const Image image(cairo_image_surface_create_from_png(file.string().c_str()), cairo_surface_destroy);
    if (cairo_surface_status(image.get()) != CAIRO_STATUS_SUCCESS) throw OutputError("cannot read " + file.string());
    WebpImage picture(image);
    // the height follows from the width
    if (width < width_of(image) && !WebPPictureRescale(picture.get(), width, 0)) throw std::bad_alloc();
    return encoded(picture);
}

Image stacked(const Image& above, const Image& below) {
    Image page = blank(width_of(above), height_of(above) + height_of(below));
    place(above, page, 0);
    place(below, page, height_of(above));
    return page;
}

}  // namespace knap
