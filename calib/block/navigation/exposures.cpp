// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/navigation/exposures.h"

#include <algorithm>
#include <map>

#include "core/error.h"

namespace swath::calib {
namespace {

std::string list_of(const std::set<std::string>& names) {
  std::string out;
  for (const std::string& n : names) out += (out.empty() ? "" : ", ") + n;
  return out;
}

class ExposureFinder {
 public:
  ExposureFinder(const core::EventData& events, const std::vector<io::SurveyCamera>& cameras, const std::vector<io::LineWindow>& lines,
                 const std::string& survey)
      : events_(events), cameras_(cameras), lines_(lines), survey_(survey), techniques_(events.technique.begin(), events.technique.end()) {
    for (const io::SurveyCamera& c : cameras) technique_of_.push_back(technique_of(c));
  }

  Exposures from_events() const {
    for (size_t k = 1; k < cameras_.size(); ++k)
      for (size_t other = 0; other < k; ++other)
        if (technique_of_[k] == technique_of_[other])
          throw core::usage_error("cameras " + cameras_[other].name + " and " + cameras_[k].name + " have the same events", survey_,
                                  "state technique of each [[camera]], or list the images with their cameras in [[image]]");
    Exposures out;
    std::map<std::string, std::string> known;
    for (std::uint32_t c = 0; c < cameras_.size(); ++c)
      for (size_t e = 0; e < events_.size(); ++e) {
        if (events_.technique[e] != technique_of_[c]) continue;
        const auto [it, is_new] = known.try_emplace(events_.id[e], cameras_[c].name);
        if (!is_new)
          throw core::Error("image " + events_.id[e] + " is there twice: two events of " +
                                (it->second == cameras_[c].name ? "camera " + it->second : it->second + " and " + cameras_[c].name) +
                                " have this id",
                            survey_, "give each image a name of its own: a table of [[image]] with event, camera and name");
        out.images.push_back(exposure(events_.id[e], c, e, {}));
      }
    return out;
  }

  Exposures from_list(const std::vector<io::ListedImage>& listed) const {
    Exposures out;
    std::map<std::string, std::string> names;
    std::map<std::pair<std::uint32_t, size_t>, std::string> taken;
    const auto number = event_numbers();
    for (const io::ListedImage& image : listed) {
      const auto [it, is_new] = names.try_emplace(image.name, image.place);
      if (!is_new) throw core::Error("image " + image.name + " is there twice, first in " + it->second, image.place);
      const std::uint32_t camera = camera_of(image);
      const auto event = number.find({technique_of_[camera], image.event});
      if (event == number.end())
        throw core::Error("image " + image.name + " is of event " + image.event + ", and no event of the technique " +
                              technique_of_[camera] + " has that id",
                          image.place, "the event may be missing; or take the image out of the list");
      if (event->second.size() > 1)
        throw core::Error("image " + image.name + " is of event " + image.event + ", and " + std::to_string(event->second.size()) +
                              " events of the technique " + technique_of_[camera] + " have that id",
                          image.place, "number the events of all files through");
      const size_t e = event->second.front();
      const auto [other, is_free] = taken.try_emplace({camera, e}, image.name);
      if (!is_free)
        throw core::Error("images " + other->second + " and " + image.name + " are of one event, " + image.event, image.place,
                          "each exposure of a camera is one image");
      out.images.push_back(exposure(image.name, camera, e, image.strip));
    }
    const std::set<std::string> of_cameras(technique_of_.begin(), technique_of_.end());
    std::set<size_t> used;
    for (const auto& [key, name] : taken) used.insert(key.second);
    for (size_t e = 0; e < events_.size(); ++e) out.events_left_out += of_cameras.contains(events_.technique[e]) && !used.contains(e);
    return out;
  }

 private:
  std::string technique_of(const io::SurveyCamera& c) const {
    if (c.technique.empty() && techniques_.size() > 1)
      throw core::usage_error("the events are of several techniques, and camera " + c.name + " states none: " + list_of(techniques_),
                              survey_, "state technique of [[camera]]");
    if (c.technique.empty()) return techniques_.empty() ? std::string() : *techniques_.begin();
    expect_technique(c, techniques_, survey_);
    return c.technique;
  }

  std::map<std::pair<std::string, std::string>, std::vector<size_t>> event_numbers() const {
    std::map<std::pair<std::string, std::string>, std::vector<size_t>> out;
    for (size_t e = 0; e < events_.size(); ++e) out[{events_.technique[e], events_.id[e]}].push_back(e);
    return out;
  }

  std::uint32_t camera_of(const io::ListedImage& image) const {
    if (!image.camera && cameras_.size() == 1) return 0;
    std::string names;
    for (std::uint32_t c = 0; c < cameras_.size(); ++c) {
      if (image.camera && cameras_[c].name == *image.camera) return c;
      names += (c ? ", " : "") + cameras_[c].name;
    }
    throw core::Error(image.camera ? "camera " + *image.camera + " of image " + image.name + " is not in the survey"
                                   : "the survey has several cameras, and the list does not say which took image " + image.name,
                      image.place, image.camera ? "its [[camera]] are " + names : "add a column of the camera: " + names);
  }

  Exposure exposure(const std::string& name, std::uint32_t camera, size_t event, std::optional<int> strip) const {
    Exposure out{
        name, camera, strip.value_or(events_.strip[event]), events_.time[event], events_.sigma[event], events_.doubtful[event] != 0, event};
    if (!strip && out.strip == 0)
      for (const io::LineWindow& l : lines_)
        if (out.time >= l.start && out.time <= l.end) out.strip = l.id;
    return out;
  }

  const core::EventData& events_;
  const std::vector<io::SurveyCamera>& cameras_;
  const std::vector<io::LineWindow>& lines_;
  const std::string& survey_;
  std::set<std::string> techniques_;
  std::vector<std::string> technique_of_;
};

}  // namespace

void expect_technique(const io::SurveyCamera& c, const std::set<std::string>& techniques, const std::string& survey) {
  if (!c.technique.empty() && !techniques.contains(c.technique))
    throw core::usage_error("no event is of the technique " + c.technique + " of camera " + c.name, survey,
                            techniques.empty() ? "there is no event" : "the events are of " + list_of(techniques));
}

Exposures exposures_of(const core::EventData& events, const std::vector<io::SurveyCamera>& cameras,
                       const std::vector<io::ListedImage>& listed, const std::vector<io::LineWindow>& lines, const std::string& survey) {
  const ExposureFinder finder(events, cameras, lines, survey);
  Exposures out = listed.empty() ? finder.from_events() : finder.from_list(listed);
  std::stable_sort(out.images.begin(), out.images.end(), [](const Exposure& a, const Exposure& b) { return a.time < b.time; });
  return out;
}

}  // namespace swath::calib
